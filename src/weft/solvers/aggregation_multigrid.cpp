#include "weft/solvers/aggregation_multigrid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "weft/core/pack.h"
#include "weft/core/random.h"
#include "weft/solvers/aggregates.h"
#include "weft/solvers/dense_inverse.h"

namespace weft::engine {
namespace {

constexpr int kGrain = 256;        // slices per chunk of work
constexpr int kCoarsest = 60;      // levels up to this many particles are solved directly
constexpr int kMaxCoarsest = 400;  // … if it cannot be coarsened any more
constexpr std::size_t kMaxLevels = 12;
constexpr double kJacobiWeight = 1.5;  // of the smoother, over the largest eigenvalue of D⁻¹A

struct In3 {
  const float *x, *y, *z;
};
struct Out3 {
  float *x, *y, *z;
};

template <int W>
struct Three {
  Pack<W> x, y, z;
};

/// Σ_j a_ij u_j for W rows from lane `lane` of a slice.
template <int W>
WEFT_ALWAYS_INLINE Three<W> row_sums(const SlicedMatrix& a, In3 u, int slice, int lane) {
  Three<W> sum{};
  for (int row = a.slice_begin[slice]; row < a.slice_begin[slice + 1]; ++row) {
    const int entry = row * kPackLanes + lane;
    const Pack<W> value = load<W>(a.value.data() + entry);
    const int* column = a.column.data() + entry;
    Pack<W> x{}, y{}, z{};
    for (int l = 0; l < W; ++l) {
      x[l] = u.x[column[l]];
      y[l] = u.y[column[l]];
      z[l] = u.z[column[l]];
    }
    sum.x += value * x;
    sum.y += value * y;
    sum.z += value * z;
  }
  return sum;
}

template <int W>
WEFT_ALWAYS_INLINE Three<W> load3(In3 u, std::ptrdiff_t i) {
  return {load<W>(u.x + i), load<W>(u.y + i), load<W>(u.z + i)};
}

template <int W>
WEFT_ALWAYS_INLINE void store3(Out3 u, std::ptrdiff_t i, const Three<W>& v) {
  store(u.x + i, v.x);
  store(u.y + i, v.y);
  store(u.z + i, v.z);
}

/// out = inverse · b
template <int W>
WEFT_ALWAYS_INLINE void scale_body(const float* inverse, In3 b, Out3 out, int begin, int end) {
  for_packs<W>((end - begin) * kPackLanes, [&](std::ptrdiff_t offset, int) WEFT_INLINE_LAMBDA {
    const std::ptrdiff_t i = begin * kPackLanes + offset;
    const Pack<W> w = load<W>(inverse + i);
    const Three<W> v = load3<W>(b, i);
    store3<W>(out, i, {w * v.x, w * v.y, w * v.z});
  });
}
WEFT_MULTIVERSION_PACKS(scale, (const float* inverse, In3 b, Out3 out, int begin, int end),
                        (inverse, b, out, begin, end))

struct Smoothing {
  const SlicedMatrix& couplings;
  const float *diagonal, *inverse;
};

/// out = b − A x; with kSmooth x + inverse · (b − A x), zero where inverse is, and dots[slice] = b·out.
template <int W, bool kSmooth>
WEFT_ALWAYS_INLINE void residual_slices(const Smoothing& s, In3 b, In3 x, Out3 out, int begin, int end,
                                        double* dots) {
  for (int slice = begin; slice < end; ++slice) {
    LaneSums<W> dot;
    for (int part = 0; part < kPackLanes / W; ++part) {
      const int i = slice * kPackLanes + part * W;
      const Three<W> side = load3<W>(b, i), here = load3<W>(x, i);
      const Three<W> sum = row_sums<W>(s.couplings, x, slice, part * W);
      const Pack<W> d = load<W>(s.diagonal + i);
      Three<W> r{side.x - d * here.x + sum.x, side.y - d * here.y + sum.y, side.z - d * here.z + sum.z};
      if (kSmooth) {
        const Pack<W> w = load<W>(s.inverse + i), zero = broadcast<W>(0);
        r = {select_less(zero, w, here.x + w * r.x, zero), select_less(zero, w, here.y + w * r.y, zero),
             select_less(zero, w, here.z + w * r.z, zero)};
        dot.add(part, side.x * r.x + side.y * r.y + side.z * r.z);
      }
      store3<W>(out, i, r);
    }
    if (kSmooth && dots) dots[slice] = dot.total();
  }
}

template <int W>
WEFT_ALWAYS_INLINE void smooth_body(const Smoothing& s, In3 b, In3 x, Out3 out, int begin, int end,
                                    double* dots) {
  residual_slices<W, true>(s, b, x, out, begin, end, dots);
}
WEFT_MULTIVERSION_PACKS(smooth,
                        (const Smoothing& s, In3 b, In3 x, Out3 out, int begin, int end, double* dots),
                        (s, b, x, out, begin, end, dots))

template <int W>
WEFT_ALWAYS_INLINE void residual_body(const Smoothing& s, In3 b, In3 x, Out3 out, int begin, int end) {
  residual_slices<W, false>(s, b, x, out, begin, end, nullptr);
}
WEFT_MULTIVERSION_PACKS(residual, (const Smoothing& s, In3 b, In3 x, Out3 out, int begin, int end),
                        (s, b, x, out, begin, end))

/// out = keep · out + A u
template <int W>
WEFT_ALWAYS_INLINE void transfer_body(const SlicedMatrix& a, In3 u, float keep, Out3 out, int begin,
                                      int end) {
  for (int slice = begin; slice < end; ++slice) {
    for (int lane = 0; lane < kPackLanes; lane += W) {
      const int i = slice * kPackLanes + lane;
      const Three<W> sum = row_sums<W>(a, u, slice, lane), old = load3<W>({out.x, out.y, out.z}, i);
      store3<W>(out, i, {keep * old.x + sum.x, keep * old.y + sum.y, keep * old.z + sum.z});
    }
  }
}
WEFT_MULTIVERSION_PACKS(transfer, (const SlicedMatrix& a, In3 u, float keep, Out3 out, int begin, int end),
                        (a, u, keep, out, begin, end))

In3 inputs(const Vec3Array& a) { return {a.x(), a.y(), a.z()}; }
Out3 outputs(Vec3Array& a) { return {a.x(), a.y(), a.z()}; }

/// excess + Σ c, 0 for rows that drop out.
std::vector<double> diagonal_of(const SparseMatrix& couplings, const std::vector<double>& excess) {
  std::vector<double> diagonal = excess;
  for (int i = 0; i < couplings.num_rows; ++i) {
    for (int e = couplings.begin[i]; e < couplings.begin[i + 1]; ++e) diagonal[i] += couplings.value[e];
  }
  return diagonal;
}

/// The largest eigenvalue of D⁻¹A, slightly overestimated, by a few steps of the power method.
double estimate_largest_eigenvalue(const SparseMatrix& couplings, const std::vector<double>& diagonal) {
  constexpr int kSteps = 8;
  constexpr double kSafety = 1.1;
  const int n = couplings.num_rows;
  Random random(1);
  std::vector<double> u(n), w(n);
  for (double& value : u) value = random.uniform(-0.5, 0.5);
  double eigenvalue = 1;
  for (int step = 0; step < kSteps; ++step) {
    double before = 0, after = 0;
    for (int i = 0; i < n; ++i) {
      if (diagonal[i] == 0) u[i] = 0;
      double sum = diagonal[i] * u[i];
      for (int e = couplings.begin[i]; e < couplings.begin[i + 1]; ++e)
        sum -= couplings.value[e] * u[couplings.column[e]];
      w[i] = diagonal[i] == 0 ? 0 : sum / diagonal[i];
      before += u[i] * u[i];
      after += w[i] * w[i];
    }
    if (after == 0) break;
    eigenvalue = std::sqrt(after / before);
    for (int i = 0; i < n; ++i) u[i] = w[i] / std::sqrt(after);
  }
  return kSafety * std::max(eigenvalue, 1.0);
}

/// P = (I − ω D⁻¹ A) T, where T spreads the value of an aggregate over its particles.
SparseMatrix make_prolongation(const SparseMatrix& couplings, const std::vector<double>& diagonal,
                               const Aggregates& aggregates, double largest_eigenvalue) {
  const double omega = 4 / (3 * largest_eigenvalue);
  SparseMatrix smoother, spread;
  smoother.num_columns = couplings.num_rows;
  spread.num_columns = aggregates.count;
  for (int i = 0; i < couplings.num_rows; ++i) {
    if (aggregates.of[i] >= 0) {
      smoother.add_entry(i, 1 - omega);
      for (int e = couplings.begin[i]; e < couplings.begin[i + 1]; ++e)
        smoother.add_entry(couplings.column[e], omega * couplings.value[e] / diagonal[i]);
      spread.add_entry(aggregates.of[i], 1);
    }
    smoother.end_row();
    spread.end_row();
  }
  return multiply(smoother, spread);
}

/// Galerkin coarse operator PᵀAP, separated into couplings and diagonal.
void coarsen(SparseMatrix& couplings, std::vector<double>& diagonal, const SparseMatrix& prolongation,
             const SparseMatrix& restriction) {
  SparseMatrix full;
  full.num_columns = couplings.num_columns;
  for (int i = 0; i < couplings.num_rows; ++i) {
    full.add_entry(i, diagonal[i]);
    for (int e = couplings.begin[i]; e < couplings.begin[i + 1]; ++e)
      full.add_entry(couplings.column[e], -couplings.value[e]);
    full.end_row();
  }
  const SparseMatrix coarse = multiply(restriction, multiply(full, prolongation));
  couplings = {};
  couplings.num_columns = coarse.num_columns;
  diagonal.assign(coarse.num_rows, 0.0);
  for (int i = 0; i < coarse.num_rows; ++i) {
    for (int e = coarse.begin[i]; e < coarse.begin[i + 1]; ++e) {
      if (coarse.column[e] == i) {
        diagonal[i] = coarse.value[e];
      } else {
        couplings.add_entry(coarse.column[e], -coarse.value[e]);
      }
    }
    couplings.end_row();
  }
}

}  // namespace

SlicedMatrix slice(const SparseMatrix& a) {
  SlicedMatrix s;
  s.slice_begin.push_back(0);
  for (int first = 0; first < a.num_rows; first += kPackLanes) {
    const int end = std::min(first + kPackLanes, a.num_rows);
    int longest = 0;
    for (int r = first; r < end; ++r) longest = std::max(longest, a.begin[r + 1] - a.begin[r]);
    const std::size_t at = s.column.size();
    s.column.resize(at + static_cast<std::size_t>(longest) * kPackLanes, 0);
    s.value.resize(s.column.size(), 0.0f);
    for (int r = first; r < end; ++r) {
      for (int e = a.begin[r]; e < a.begin[r + 1]; ++e) {
        const std::size_t to = at + static_cast<std::size_t>(e - a.begin[r]) * kPackLanes + (r - first);
        s.column[to] = a.column[e];
        s.value[to] = static_cast<float>(a.value[e]);
      }
    }
    s.slice_begin.push_back(s.slice_begin.back() + longest);
  }
  return s;
}

AggregationMultigrid::Level AggregationMultigrid::make_level(const SparseMatrix& couplings,
                                                             const std::vector<double>& diagonal,
                                                             double largest_eigenvalue) {
  Level level;
  level.size = couplings.num_rows;
  level.couplings = slice(couplings);
  level.largest_eigenvalue = largest_eigenvalue;
  level.built_diagonal = diagonal;
  level.diagonal.assign(round_up_to_pack(level.size), 0.0f);
  level.inverse = level.diagonal;
  for (Vec3Array* field : {&level.right_side, &level.value, &level.residual, &level.smoothed})
    field->resize(round_up_to_pack(level.size));
  return level;
}

void AggregationMultigrid::build(const SparseMatrix& finest, const std::vector<double>& excess) {
  SparseMatrix couplings = finest;
  std::vector<double> diagonal = diagonal_of(finest, excess);
  levels_.clear();
  coarsest_inverse_.clear();
  for (;;) {
    const double eigenvalue = estimate_largest_eigenvalue(couplings, diagonal);
    levels_.push_back(make_level(couplings, diagonal, eigenvalue));
    if (couplings.num_rows <= kCoarsest || levels_.size() == kMaxLevels) break;
    const Aggregates aggregates = find_aggregates(couplings, diagonal);
    if (aggregates.count == 0 || aggregates.count > 0.8 * couplings.num_rows) break;
    const SparseMatrix prolongation = make_prolongation(couplings, diagonal, aggregates, eigenvalue);
    const SparseMatrix restriction = transpose(prolongation);
    coarsen(couplings, diagonal, prolongation, restriction);
    levels_.back().prolong = slice(prolongation);
    levels_.back().restriction = slice(restriction);
    levels_.back().spread = restriction;
  }
  dots_.assign(levels_.front().couplings.num_slices(), 0.0);
  coarsest_ = std::move(couplings);
  add_excess(std::vector<double>(levels_.front().size, 0.0));
}

void AggregationMultigrid::add_excess(const std::vector<double>& more) {
  more_ = more;
  for (Level& level : levels_) {
    for (int i = 0; i < level.size; ++i) {
      const double d = level.built_diagonal[i] + more_[i];
      level.diagonal[i] = static_cast<float>(d);
      level.inverse[i] = d > 0 ? static_cast<float>(kJacobiWeight / (level.largest_eigenvalue * d)) : 0.0f;
    }
    if (&level == &levels_.back()) break;
    coarse_more_.assign(level.spread.num_rows, 0.0);
    for (int c = 0; c < level.spread.num_rows; ++c) {
      double sum = 0;
      for (int e = level.spread.begin[c]; e < level.spread.begin[c + 1]; ++e)
        sum += level.spread.value[e] * more_[level.spread.column[e]];
      coarse_more_[c] = std::max(sum, 0.0);
    }
    more_.swap(coarse_more_);
  }
  invert_coarsest(more_);
}

void AggregationMultigrid::invert_coarsest(const std::vector<double>& more) {
  const int n = coarsest_.num_rows;
  if (n > kMaxCoarsest) return;
  coarsest_inverse_.assign(static_cast<std::size_t>(n) * n, 0.0);
  for (int i = 0; i < n; ++i) {
    coarsest_inverse_[i * n + i] = levels_.back().built_diagonal[i] + more[i];
    for (int e = coarsest_.begin[i]; e < coarsest_.begin[i + 1]; ++e)
      coarsest_inverse_[i * n + coarsest_.column[e]] -= coarsest_.value[e];
  }
  invert_in_place(coarsest_inverse_, n);
}

void AggregationMultigrid::solve_coarsest(const float* const b[3], float* const out[3]) const {
  const Level& level = levels_.back();
  const int n = level.size;
  for (int c = 0; c < 3; ++c) {
    for (int i = 0; i < n; ++i) {
      if (coarsest_inverse_.empty()) {
        out[c][i] = level.inverse[i] * b[c][i];
        continue;
      }
      double sum = 0;
      for (int j = 0; j < n; ++j) sum += coarsest_inverse_[i * n + j] * b[c][j];
      out[c][i] = static_cast<float>(sum);
    }
  }
}

double AggregationMultigrid::apply(const Vec3Array& r, int first, JobSystem& jobs, Vec3Array& z) {
  const float* const b[3] = {r.x() + first, r.y() + first, r.z() + first};
  float* const out[3] = {z.x() + first, z.y() + first, z.z() + first};
  double sum = 0;
  if (levels_.size() == 1) {
    solve_coarsest(b, out);
    for (int c = 0; c < 3; ++c) {
      for (int i = 0; i < levels_.front().size; ++i) sum += static_cast<double>(b[c][i]) * out[c][i];
    }
    return sum;
  }
  cycle(0, b, out, jobs, dots_.data());
  for (const double d : dots_) sum += d;
  return sum;
}

void AggregationMultigrid::cycle(std::size_t l, const float* const side[3], float* const result[3],
                                 JobSystem& jobs, double* dots) {
  if (l + 1 == levels_.size()) return solve_coarsest(side, result);
  Level &fine = levels_[l], &coarse = levels_[l + 1];
  const In3 b{side[0], side[1], side[2]};
  const Smoothing s{fine.couplings, fine.diagonal.data(), fine.inverse.data()};
  const auto for_slices = [&](const Level& level, const auto& body) {
    parallel_for(jobs, level.couplings.num_slices(), kGrain, body);
  };
  for_slices(fine, [&](int begin, int end) { scale(s.inverse, b, outputs(fine.value), begin, end); });
  for_slices(fine, [&](int begin, int end) {
    residual(s, b, inputs(fine.value), outputs(fine.residual), begin, end);
  });
  for_slices(coarse, [&](int begin, int end) {
    transfer(fine.restriction, inputs(fine.residual), 0, outputs(coarse.right_side), begin, end);
  });
  const float* const coarse_side[3] = {coarse.right_side.x(), coarse.right_side.y(), coarse.right_side.z()};
  float* const coarse_result[3] = {coarse.smoothed.x(), coarse.smoothed.y(), coarse.smoothed.z()};
  cycle(l + 1, coarse_side, coarse_result, jobs, nullptr);
  for_slices(fine, [&](int begin, int end) {
    transfer(fine.prolong, inputs(coarse.smoothed), 1, outputs(fine.value), begin, end);
  });
  for_slices(fine, [&](int begin, int end) {
    smooth(s, b, inputs(fine.value), {result[0], result[1], result[2]}, begin, end, dots);
  });
}

}  // namespace weft::engine
