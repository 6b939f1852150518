#include "weft/solvers/grid_multigrid_kernels.h"

#include <algorithm>
#include <cstring>

namespace weft::engine::grid_kernels {
namespace {

/// Jacobi weight; anything from 0.7 to 1.1 works [1].
constexpr float kJacobiWeight = 0.85f;

/// Σ_j c_ij u_j.
template <int W, bool kDownLeft>
WEFT_ALWAYS_INLINE Pack<W> couple(const GridLevel& a, const float* u, std::ptrdiff_t i,
                                  std::ptrdiff_t stride) {
  const float *right = a.right.data() + i, *down = a.down.data() + i, *main = a.down_right.data() + i;
  Pack<W> sum = load<W>(right - 1) * load<W>(u + i - 1) + load<W>(right) * load<W>(u + i + 1);
  sum += load<W>(down - stride) * load<W>(u + i - stride) + load<W>(down) * load<W>(u + i + stride);
  sum +=
      load<W>(main - stride - 1) * load<W>(u + i - stride - 1) + load<W>(main) * load<W>(u + i + stride + 1);
  if (kDownLeft) {
    const float* anti = a.down_left.data() + i;
    sum += load<W>(anti - stride + 1) * load<W>(u + i - stride + 1) +
           load<W>(anti) * load<W>(u + i + stride - 1);
  }
  return sum;
}

template <int W>
WEFT_ALWAYS_INLINE void finish_body(GridLevel& a, int row_begin, int row_end) {
  using V = Pack<W>;
  const int stride = a.rows.stride();
  const float *right = a.right.data(), *down = a.down.data(), *main = a.down_right.data(),
              *anti = a.down_left.data();
  for (int j = row_begin; j < row_end; ++j) {
    const int first = a.rows.row(j);
    for_packs<W>(a.rows.row_length, [&](std::ptrdiff_t column, int) WEFT_INLINE_LAMBDA {
      const std::ptrdiff_t i = first + column;
      V sum = load<W>(right + i) + load<W>(right + i - 1) + load<W>(down + i) + load<W>(down + i - stride);
      sum += load<W>(main + i) + load<W>(main + i - stride - 1);
      sum += load<W>(anti + i) + load<W>(anti + i - stride + 1);
      const V diagonal = load<W>(a.excess.data() + i) + sum, zero = broadcast<W>(0);
      store(a.diagonal.data() + i, diagonal);
      store(a.inverse.data() + i, select_less(zero, diagonal, kJacobiWeight / diagonal, zero));
    });
  }
}

WEFT_MULTIVERSION_PACKS(finish, (GridLevel & a, int row_begin, int row_end), (a, row_begin, row_end))

/// Shares that a coarse particle receives from its fine neighbours, and the share that the fine particle
/// after it gives to the next coarse one.
struct Shares {
  float before = 0.5f, after = 0.5f, next = 0.5f;
};

/// Shares of coarse particle q for n fine particles: see coarse_length().
WEFT_ALWAYS_INLINE Shares shares_at(int q, int n) {
  if (n == 2) return {0, 1, 0};
  if (n % 2 == 0 && q == n / 2 - 1) return {0.5f, 0, 1};
  if (n % 2 == 0 && q == n / 2) return {1, 0, 0};
  return {};
}

/// One coarse particle of a row, from the fine particle q at its place and its neighbours. `given_before` is
/// the share that the fine particle before it gives to the previous coarse one.
WEFT_ALWAYS_INLINE void narrow_one(const GridMatrix& f, int q, GridMatrix& n, int out, Shares s,
                                   float given_before) {
  const float *d = f.diagonal.data() + q, *e = f.excess.data() + q, *r = f.right.data() + q,
              *c = f.down.data() + q, *dr = f.down_right.data() + q, *dl = f.down_left.data() + q;
  const float after2 = s.after * s.after, before2 = s.before * s.before, shared = s.after * s.next;
  n.excess[out] = e[0] + s.after * e[1] + s.before * e[-1];
  n.diagonal[out] = d[0] - 2 * (s.after * r[0] + s.before * r[-1]) + (after2 * d[1] + before2 * d[-1]);
  n.right[out] = (s.after * r[1] + s.next * r[0]) - shared * d[1];
  n.down[out] =
      c[0] + s.after * (dr[0] + dl[1]) + s.before * (dl[0] + dr[-1]) + (after2 * c[1] + before2 * c[-1]);
  n.down_right[out] = shared * c[1] + (s.after * dr[1] + s.next * dr[0]);
  n.down_left[out] = s.before * given_before * c[-1] + (s.before * dl[-1] + given_before * dl[0]);
}

WEFT_ALWAYS_INLINE void narrow_multi_body(const GridMatrix& fine, GridMatrix& narrow, int row_begin,
                                          int row_end) {
  const int columns = narrow.rows.row_length, length = fine.rows.row_length;
  const int regular = length % 2 == 1 ? columns : std::max(columns - 2, 0);
  for (int j = row_begin; j < row_end; ++j) {
    const int in = fine.rows.row(j), out = narrow.rows.row(j);
    WEFT_IVDEP
    for (int q = 0; q < regular; ++q) narrow_one(fine, in + 2 * q, narrow, out + q, Shares{}, 0.5f);
    for (int q = regular; q < columns; ++q) {
      const Shares here = shares_at(q, length), before = shares_at(q - 1, length);
      narrow_one(fine, in + 2 * q, narrow, out + q, here, before.after);
    }
  }
}

WEFT_MULTIVERSION(narrow_multi, (const GridMatrix& fine, GridMatrix& narrow, int row_begin, int row_end),
                  (fine, narrow, row_begin, row_end))

template <int W>
WEFT_ALWAYS_INLINE void merge_body(const GridMatrix& n, GridMatrix& coarse, int row_begin, int row_end) {
  using V = Pack<W>;
  const int s = n.rows.stride();
  const float *e = n.excess.data(), *d = n.diagonal.data(), *r = n.right.data(), *c = n.down.data(),
              *dr = n.down_right.data(), *dl = n.down_left.data();
  for (int row = row_begin; row < row_end; ++row) {
    const Shares shares = shares_at(row, n.rows.num_rows);
    const float before = shares.before, after = shares.after, next = shares.next;
    const float after2 = after * after, before2 = before * before, shared = after * next;
    const int in = n.rows.row(2 * row), out = coarse.rows.row(row);
    for_packs<W>(coarse.rows.row_length, [&](std::ptrdiff_t column, int) WEFT_INLINE_LAMBDA {
      const std::ptrdiff_t i = in + column, o = out + column;
      const V e0 = load<W>(e + i), e1 = load<W>(e + i + s), e2 = load<W>(e + i - s);
      store(coarse.excess.data() + o, e0 + after * e1 + before * e2);
      const V r0 = load<W>(r + i), r1 = load<W>(r + i + s), r2 = load<W>(r + i - s);
      const V dr0 = load<W>(dr + i), dr2 = load<W>(dr + i - s), dr1 = load<W>(dr + i + s);
      const V dl0 = load<W>(dl + i + 1), dl2 = load<W>(dl + i + 1 - s);
      store(coarse.right.data() + o,
            r0 + after * (dr0 + dl0) + before * (dl2 + dr2) + (after2 * r1 + before2 * r2));
      const V c0 = load<W>(c + i), c1 = load<W>(c + i + s), d1 = load<W>(d + i + s);
      store(coarse.down.data() + o, (after * c1 + next * c0) - shared * d1);
      store(coarse.down_right.data() + o, shared * r1 + (after * dr1 + next * dr0));
      // From here to the particle below on the left: its coupling is stored at the upper right end.
      const V left1 = load<W>(r + i - 1 + s), own0 = load<W>(dl + i), own1 = load<W>(dl + i + s);
      store(coarse.down_left.data() + o, shared * left1 + (next * own0 + after * own1));
    });
  }
}

WEFT_MULTIVERSION_PACKS(merge, (const GridMatrix& n, GridMatrix& coarse, int row_begin, int row_end),
                        (n, coarse, row_begin, row_end))

template <int W>
WEFT_ALWAYS_INLINE void smooth_from_zero_multi_body(const GridLevel& a, ConstComponent3 b, Component3 x,
                                                    int row_begin, int row_end) {
  for (int j = row_begin; j < row_end; ++j) {
    const int first = a.rows.row(j);
    for_packs<W>(a.rows.row_length, [&](std::ptrdiff_t column, int) WEFT_INLINE_LAMBDA {
      const std::ptrdiff_t i = first + column;
      const Pack<W> inverse = load<W>(a.inverse.data() + i);
      store(x.x + i, inverse * load<W>(b.x + i));
      store(x.y + i, inverse * load<W>(b.y + i));
      store(x.z + i, inverse * load<W>(b.z + i));
    });
  }
}

WEFT_MULTIVERSION_PACKS(smooth_from_zero_multi,
                        (const GridLevel& a, ConstComponent3 b, Component3 x, int row_begin, int row_end),
                        (a, b, x, row_begin, row_end))

template <int W, bool kDownLeft>
WEFT_ALWAYS_INLINE void smooth_rows(const GridLevel& a, ConstComponent3 b, ConstComponent3 x, Component3 out,
                                    int row_begin, int row_end, double* dots) {
  using V = Pack<W>;
  const int stride = a.rows.stride();
  for (int j = row_begin; j < row_end; ++j) {
    const int first = a.rows.row(j);
    LaneSums<W> sum;
    for_packs<W>(a.rows.row_length, [&](std::ptrdiff_t column, int part) WEFT_INLINE_LAMBDA {
      const std::ptrdiff_t i = first + column;
      const V inverse = load<W>(a.inverse.data() + i), diagonal = load<W>(a.diagonal.data() + i);
      const V zero = broadcast<W>(0);
      const auto sweep = [&](V side, const float* u) WEFT_INLINE_LAMBDA {
        const V here = load<W>(u + i);
        const V residual = side - diagonal * here + couple<W, kDownLeft>(a, u, i, stride);
        return select_less(zero, inverse, here + inverse * residual, zero);
      };
      // All loads before the first store: the compiler cannot prove that couplings stay unchanged.
      const V sx = load<W>(b.x + i), sy = load<W>(b.y + i), sz = load<W>(b.z + i);
      const V rx = sweep(sx, x.x), ry = sweep(sy, x.y), rz = sweep(sz, x.z);
      store(out.x + i, rx);
      store(out.y + i, ry);
      store(out.z + i, rz);
      sum.add(part, sx * rx + sy * ry + sz * rz);
    });
    if (dots) dots[j] = sum.total();
  }
}

template <int W>
WEFT_ALWAYS_INLINE void smooth_multi_body(const GridLevel& a, ConstComponent3 b, ConstComponent3 x,
                                          Component3 out, int row_begin, int row_end, double* dots) {
  if (a.has_down_left) return smooth_rows<W, true>(a, b, x, out, row_begin, row_end, dots);
  smooth_rows<W, false>(a, b, x, out, row_begin, row_end, dots);
}

WEFT_MULTIVERSION_PACKS(smooth_multi,
                        (const GridLevel& a, ConstComponent3 b, ConstComponent3 x, Component3 out,
                         int row_begin, int row_end, double* dots),
                        (a, b, x, out, row_begin, row_end, dots))

/// Residuals of three rows with padding at both ends; per thread, kept between calls.
class ResidualRows {
 public:
  /// Resizes only; contents are undefined.
  void fit(int row_length) {
    pitch_ = round_up_to_pack(row_length) + 2 * kPackLanes;
    const auto size = static_cast<std::size_t>(9) * pitch_;
    if (values_.size() < size) values_.resize(size);
  }

  Component3 row(int j) {
    float* begin = values_.data() + static_cast<std::size_t>((j + 3) % 3) * 3 * pitch_ + kPackLanes;
    return {begin, begin + pitch_, begin + 2 * pitch_};
  }

 private:
  int pitch_ = 0;
  std::vector<float> values_;
};

template <int W, bool kDownLeft>
WEFT_ALWAYS_INLINE void residual_row(const GridLevel& a, ConstComponent3 b, ConstComponent3 x, int j,
                                     Component3 out) {
  using V = Pack<W>;
  const int stride = a.rows.stride(), first = a.rows.row(j);
  for_packs<W>(a.rows.row_length, [&](std::ptrdiff_t column, int) WEFT_INLINE_LAMBDA {
    const std::ptrdiff_t i = first + column;
    const V diagonal = load<W>(a.diagonal.data() + i);
    const auto residual = [&](const float* side, const float* u) WEFT_INLINE_LAMBDA {
      return load<W>(side + i) - diagonal * load<W>(u + i) + couple<W, kDownLeft>(a, u, i, stride);
    };
    const V rx = residual(b.x, x.x), ry = residual(b.y, x.y), rz = residual(b.z, x.z);
    store(out.x + column, rx);
    store(out.y + column, ry);
    store(out.z + column, rz);
  });
}

/// out[q] = in[2q] + ½ (in[2q−1] + in[2q+1]); see coarse_length() for the end of an even row.
WEFT_ALWAYS_INLINE void halve(float* in, int fine_length, float* out, int coarse_length) {
  const float last = in[fine_length - 1];
  in[-1] = in[fine_length] = 0;
  const bool is_even = fine_length % 2 == 0, is_pair = fine_length == 2;
  if (is_even) in[fine_length - 1] = is_pair ? 2 * last : 0;
  const int inner = is_even && !is_pair ? coarse_length - 1 : coarse_length;
  WEFT_IVDEP
  for (int q = 0; q < inner; ++q) out[q] = in[2 * q] + 0.5f * (in[2 * q - 1] + in[2 * q + 1]);
  if (inner < coarse_length) out[inner] = last;
}

template <int W, bool kDownLeft>
WEFT_ALWAYS_INLINE void restrict_rows(const GridLevel& fine, ConstComponent3 b, ConstComponent3 x,
                                      const GridLevel& coarse, Component3 out, int row_begin, int row_end,
                                      ResidualRows& rows) {
  using V = Pack<W>;
  const int length = fine.rows.row_length, num_rows = fine.rows.num_rows;
  const auto compute = [&](int j) WEFT_INLINE_LAMBDA {
    const Component3 row = rows.row(j);
    if (j >= 0 && j < num_rows) return residual_row<W, kDownLeft>(fine, b, x, j, row);
    for (float* component : {row.x, row.y, row.z}) std::fill_n(component, round_up_to_pack(length), 0.0f);
  };
  compute(2 * row_begin - 1);
  for (int j = row_begin; j < row_end; ++j) {
    const Component3 before = rows.row(2 * j - 1), here = rows.row(2 * j), after = rows.row(2 * j + 1);
    compute(2 * j);
    compute(2 * j + 1);
    const Shares shares = shares_at(j, num_rows);
    const float weight_before = shares.before, weight_after = shares.after;
    const auto combine = [&](float* at, const float* up, const float* down) WEFT_INLINE_LAMBDA {
      for_packs<W>(length, [&](std::ptrdiff_t i, int) WEFT_INLINE_LAMBDA {
        const V sum = load<W>(at + i) + weight_before * load<W>(up + i) + weight_after * load<W>(down + i);
        store(at + i, sum);
      });
    };
    // All three before any is halved: halving reads them shifted, which stalls while stores are in flight.
    combine(here.x, before.x, after.x);
    combine(here.y, before.y, after.y);
    combine(here.z, before.z, after.z);
    const int to = coarse.rows.row(j);
    halve(here.x, length, out.x + to, coarse.rows.row_length);
    halve(here.y, length, out.y + to, coarse.rows.row_length);
    halve(here.z, length, out.z + to, coarse.rows.row_length);
  }
}

template <int W>
WEFT_ALWAYS_INLINE void restrict_multi_body(const GridLevel& fine, ConstComponent3 b, ConstComponent3 x,
                                            const GridLevel& coarse, Component3 out, int row_begin,
                                            int row_end, ResidualRows& rows) {
  if (fine.has_down_left) return restrict_rows<W, true>(fine, b, x, coarse, out, row_begin, row_end, rows);
  restrict_rows<W, false>(fine, b, x, coarse, out, row_begin, row_end, rows);
}

WEFT_MULTIVERSION_PACKS(restrict_multi,
                        (const GridLevel& fine, ConstComponent3 b, ConstComponent3 x, const GridLevel& coarse,
                         Component3 out, int row_begin, int row_end, ResidualRows& rows),
                        (fine, b, x, coarse, out, row_begin, row_end, rows))

/// x += P e along a fine row that lies on one coarse row, or between two.
template <bool kBetween>
WEFT_ALWAYS_INLINE void prolong_row(const float* e0, const float* e1, int coarse_length, int fine_length,
                                    float* x) {
  const auto at = [&](int q) WEFT_INLINE_LAMBDA { return kBetween ? 0.5f * (e0[q] + e1[q]) : e0[q]; };
  const bool is_even = fine_length % 2 == 0;
  const int inner = is_even && fine_length > 2 ? coarse_length - 2 : coarse_length - 1;
  WEFT_IVDEP
  for (int q = 0; q < inner; ++q) {
    x[2 * q] += at(q);
    x[2 * q + 1] += 0.5f * (at(q) + at(q + 1));
  }
  x[2 * inner] += at(inner);
  if (is_even) x[2 * inner + 1] += at(coarse_length - 1);
}

WEFT_ALWAYS_INLINE void prolong_multi_body(const GridLevel& coarse, ConstComponent3 e, const GridLevel& fine,
                                           Component3 x, int row_begin, int row_end) {
  const int coarse_length = coarse.rows.row_length, fine_length = fine.rows.row_length;
  const int last = fine.rows.num_rows - 1;
  for (int j = row_begin; j < row_end; ++j) {
    const bool is_between = j % 2 == 1 && j < last;
    const int row = j == last ? coarse.rows.num_rows - 1 : j / 2;
    const int in = coarse.rows.row(row), in1 = coarse.rows.row(row + 1), out = fine.rows.row(j);
    const auto add = [&](const float* from, float* to) WEFT_INLINE_LAMBDA {
      if (is_between) {
        prolong_row<true>(from + in, from + in1, coarse_length, fine_length, to + out);
      } else {
        prolong_row<false>(from + in, from + in, coarse_length, fine_length, to + out);
      }
    };
    add(e.x, x.x);
    add(e.y, x.y);
    add(e.z, x.z);
  }
}

WEFT_MULTIVERSION(prolong_multi,
                  (const GridLevel& coarse, ConstComponent3 e, const GridLevel& fine, Component3 x,
                   int row_begin, int row_end),
                  (coarse, e, fine, x, row_begin, row_end))

}  // namespace

void finish_rows(GridLevel& level, int row_begin, int row_end) { finish(level, row_begin, row_end); }

void narrow_rows(const GridMatrix& fine, GridMatrix& narrow, int row_begin, int row_end) {
  narrow_multi(fine, narrow, row_begin, row_end);
}

void merge_rows(const GridMatrix& narrow, GridMatrix& coarse, int row_begin, int row_end) {
  merge(narrow, coarse, row_begin, row_end);
}

void smooth_from_zero(const GridLevel& level, ConstComponent3 b, Component3 x, int row_begin, int row_end) {
  smooth_from_zero_multi(level, b, x, row_begin, row_end);
}

void smooth(const GridLevel& level, ConstComponent3 b, ConstComponent3 x, Component3 out, int row_begin,
            int row_end, double* dots) {
  smooth_multi(level, b, x, out, row_begin, row_end, dots);
}

void restrict_residual(const GridLevel& fine, ConstComponent3 b, ConstComponent3 x, const GridLevel& coarse,
                       Component3 out, int row_begin, int row_end) {
  static thread_local ResidualRows rows;
  rows.fit(fine.rows.row_length);
  restrict_multi(fine, b, x, coarse, out, row_begin, row_end, rows);
}

void prolong(const GridLevel& coarse, ConstComponent3 e, const GridLevel& fine, Component3 x, int row_begin,
             int row_end) {
  prolong_multi(coarse, e, fine, x, row_begin, row_end);
}

}  // namespace weft::engine::grid_kernels
