/// The springs of a grid, coloured without index arrays.
///
/// Particles are sorted into sixteen planes by their column and row modulo 4:
///
///     0 1 2 3 0 1 2     column i, row j: plane 4 (j mod 4) + i mod 4, place (j / 4) · pitch + i / 4
///     4 5 6 7 4 5 6
///     8 9 …             pitch: places per row of a plane, ⌈columns/4⌉
///
/// No spring reaches further than two, so all springs of one direction that start in the same plane end in
/// one other plane, at a constant distance in memory: they form a colour, without gathers or empty SIMD
/// lanes. Blocks of rows stay in the cache while all colours pass over them; springs between two blocks come
/// last.

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "weft/integrators/xpbd_projection.h"

namespace weft::engine {
namespace {

constexpr int kClasses = 4;    // of columns, and of rows
constexpr int kBlockRows = 8;  // of a plane, in a block: 32 rows of the grid
constexpr int kGrain = 4096;   // particles per chunk of work

struct Rows {
  float *x, *y, *z;
};

/// Springs of one colour.
struct Strip {
  int from, to;         // first places of the planes; `to` includes the step to the neighbour
  int rows;             // of the plane that have such springs
  bool leaves_row;      // ends a row of the plane further down
  int columns;          // −1, 0, 1: offset in places within a row
  const float* exists;  // 1 where a place of a block has such a spring, 0 beyond the last column
  float stiffness, rest_length;
};

struct GridArrays {
  int pitch;
  Rows y, c, motion;
  const float* inv_mass;
  bool is_projected;
};

template <int W>
struct Pack3 {
  Pack<W> x, y, z;
};

template <int W>
WEFT_ALWAYS_INLINE Pack3<W> load3(const Rows& a, std::ptrdiff_t i) {
  return {load<W>(a.x + i), load<W>(a.y + i), load<W>(a.z + i)};
}

template <int W>
WEFT_ALWAYS_INLINE Pack3<W> sum(const Pack3<W>& a, const Pack3<W>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

template <int W>
WEFT_ALWAYS_INLINE Pack3<W> difference(const Pack3<W>& a, const Pack3<W>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

template <int W>
WEFT_ALWAYS_INLINE Pack<W> dot(const Pack3<W>& a, const Pack3<W>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// a[i…] = before + factor · by
template <int W>
WEFT_ALWAYS_INLINE void store_sum(const Rows& a, std::ptrdiff_t i, const Pack3<W>& before, Pack<W> factor,
                                  const Pack3<W>& by) {
  store(a.x + i, before.x + factor * by.x);
  store(a.y + i, before.y + factor * by.y);
  store(a.z + i, before.z + factor * by.z);
}

/// Projects W springs, the first from place p to place q.
template <int W, bool kDamped>
WEFT_ALWAYS_INLINE void project_pack(const GridArrays& a, const SpringNumbers& spring, std::ptrdiff_t p,
                                     std::ptrdiff_t q, const float* exists) {
  using V = Pack<W>;
  const Pack3<W> ci = load3<W>(a.c, p), cj = load3<W>(a.c, q), moved = difference(cj, ci);
  const Pack3<W> d = sum(difference(load3<W>(a.y, q), load3<W>(a.y, p)), moved);
  Pack3<W> r{};
  if (kDamped) r = sum(difference(load3<W>(a.motion, q), load3<W>(a.motion, p)), moved);
  const V wi = load<W>(a.inv_mass + p), wj = load<W>(a.inv_mass + q), mask = load<W>(exists);
  const SpringPush<V> push =
      spring_push<kDamped, V>(spring.elastic, spring.damping, spring.rest_length, a.is_projected, dot(d, d),
                              kDamped ? dot(d, r) : V{}, wi + wj);
  Pack3<W> by{push.along_d * d.x, push.along_d * d.y, push.along_d * d.z};
  if (kDamped) by = sum(by, {push.along_r * r.x, push.along_r * r.y, push.along_r * r.z});
  store_sum(a.c, p, ci, mask * wi, by);
  store_sum(a.c, q, cj, 0.0f - mask * wj, by);
}

/// Projects a strip's springs that start in places [begin, end) of a block whose first place is `first`.
template <int W, bool kDamped>
WEFT_ALWAYS_INLINE void project_places(const GridArrays& a, const Strip& strip, const SpringNumbers& spring,
                                       std::ptrdiff_t first, std::ptrdiff_t begin, std::ptrdiff_t end) {
  std::ptrdiff_t i = begin;
  for (; i + W <= end; i += W)
    project_pack<W, kDamped>(a, spring, strip.from + i, strip.to + i, strip.exists + (i - first));
  for (; W > 4 && i + 4 <= end; i += 4)
    project_pack<4, kDamped>(a, spring, strip.from + i, strip.to + i, strip.exists + (i - first));
  for (; i < end; ++i)
    project_pack<1, kDamped>(a, spring, strip.from + i, strip.to + i, strip.exists + (i - first));
}

/// The springs inside the block of plane rows [row_begin, row_end), or those that leave it.
struct Block {
  int row_begin, row_end;
  bool leaving;
};

struct GridPass {
  GridArrays arrays;
  const std::vector<Strip>* strips;
  float step, damping;
};

template <int W, bool kDamped>
WEFT_ALWAYS_INLINE void project_strips(const GridPass& pass, const Block& block) {
  for (const Strip& strip : *pass.strips) {
    if (block.leaving && !strip.leaves_row) continue;
    const int begin = block.leaving ? block.row_end - 1 : block.row_begin;
    const int end =
        std::min(strip.rows, block.leaving || !strip.leaves_row ? block.row_end : block.row_end - 1);
    const SpringNumbers spring{pass.step * pass.step * strip.stiffness, pass.step * pass.damping,
                               strip.rest_length};
    // Springs that would start at a row's last place, or end before its first, do not exist. At the block's
    // edge their ends must not be accessed: they belong to another thread.
    const std::ptrdiff_t pitch = pass.arrays.pitch;
    project_places<W, kDamped>(pass.arrays, strip, spring, block.row_begin * pitch,
                               begin * pitch + (strip.columns < 0), end * pitch - (strip.columns > 0));
  }
}

template <int W>
WEFT_ALWAYS_INLINE void project_block_body(const GridPass& pass, const Block& block) {
  if (pass.damping > 0) return project_strips<W, true>(pass, block);
  project_strips<W, false>(pass, block);
}

WEFT_MULTIVERSION_PACKS(project_block, (const GridPass& pass, const Block& block), (pass, block))

/// One component of a row of the grid: `plane_pitch` from one class of columns to the next.
struct PredictedRow {
  int columns, plane_pitch;
  float step, drag_factor, velocity_gain;
};

WEFT_ALWAYS_INLINE void predict_row_body(const PredictedRow& a, const float* x, float* v, float* y, float* c,
                                         float* motion) {
  const auto one = [&](int m, int r) WEFT_INLINE_LAMBDA {
    const int i = kClasses * m + r, place = r * a.plane_pitch + m;
    v[i] = a.drag_factor * v[i] + a.velocity_gain;
    const float moved = a.step * v[i];
    motion[place] = moved;
    y[place] = x[i] + moved;
    c[place] = 0;
  };
  const int full = a.columns / kClasses;
  WEFT_IVDEP
  for (int m = 0; m < full; ++m) {
    for (int r = 0; r < kClasses; ++r) one(m, r);
  }
  for (int r = 0; r < a.columns % kClasses; ++r) one(full, r);
}

WEFT_MULTIVERSION(predict_row,
                  (const PredictedRow& a, const float* x, float* v, float* y, float* c, float* motion),
                  (a, x, v, y, c, motion))

struct FinishedRow {
  int columns, plane_pitch;
  float step, rate;  // rate: 1/h
};

WEFT_ALWAYS_INLINE void finish_row_body(const FinishedRow& a, const float* c, float* x, float* v) {
  const auto one = [&](int m, int r) WEFT_INLINE_LAMBDA {
    const int i = kClasses * m + r;
    v[i] += a.rate * c[r * a.plane_pitch + m];
    x[i] += a.step * v[i];
  };
  const int full = a.columns / kClasses;
  WEFT_IVDEP
  for (int m = 0; m < full; ++m) {
    for (int r = 0; r < kClasses; ++r) one(m, r);
  }
  for (int r = 0; r < a.columns % kClasses; ++r) one(full, r);
}

WEFT_MULTIVERSION(finish_row, (const FinishedRow& a, const float* c, float* x, float* v), (a, c, x, v))

class GridProjection final : public ClothProjection {
 public:
  explicit GridProjection(const ClothTopology& topology)
      : grid_(*topology.grid),
        model_(topology.spring_model),
        pitch_(divide_up(grid_.num_columns(), kClasses)),
        plane_rows_(divide_up(grid_.num_rows(), kClasses)) {
    // A multiple of a pack keeps planes aligned; one more pack avoids cache conflicts at page size.
    plane_pitch_ = round_up_to_pack(pitch_ * plane_rows_) + kPackLanes;
    const std::size_t size = static_cast<std::size_t>(plane_pitch_) * kClasses * kClasses + kPackLanes;
    storage_.assign(kArrays * size + kPackLanes, 0.0f);
    float* next = aligned(storage_.data());
    for (float** array :
         {&y_.x, &y_.y, &y_.z, &c_.x, &c_.y, &c_.z, &motion_.x, &motion_.y, &motion_.z, &inv_mass_}) {
      *array = next;
      next += size;
    }
    make_masks();
  }

  void set_numbers(const ClothModel& model, const std::vector<int>& pinned) override {
    for (int i = 0; i < model.num_particles(); ++i)
      inv_mass_[place(i)] = static_cast<float>(1 / model.mass[i]);
    for (const int i : pinned) inv_mass_[place(i)] = 0;
    make_strips(model.material);
    damping_ = static_cast<float>(model.material.damping);
  }

  void predict(const XpbdSubstep& substep, JobSystem& jobs, ClothState& state) override {
    const auto run = [&](int component, const float* x, float* v, float* y, float* c, float* motion) {
      const PredictedRow row{grid_.num_columns(), plane_pitch_, substep.step, substep.drag_factor,
                             substep.velocity_gain[component]};
      for_rows(jobs, [&](int first, int at) {
        predict_row(row, x + first, v + first, y + at, c + at, motion + at);
      });
    };
    run(0, state.x.x(), state.v.x(), y_.x, c_.x, motion_.x);
    run(1, state.x.y(), state.v.y(), y_.y, c_.y, motion_.y);
    run(2, state.x.z(), state.v.z(), y_.z, c_.z, motion_.z);
  }

  void move_to(int particle, const Vec3& y, const Vec3& motion) override {
    const int at = place(particle);
    set(y_, at, y);
    set(motion_, at, motion);
  }

  void project(const XpbdSubstep& substep, JobSystem& jobs) override {
    const GridPass pass{
        {pitch_, y_, c_, motion_, inv_mass_, substep.is_projected}, &strips_, substep.step, damping_};
    const int num_blocks = divide_up(plane_rows_, kBlockRows);
    const int grain = std::max(1, kGrain / (kClasses * kBlockRows * grid_.num_columns()));
    for (const bool leaving : {false, true}) {
      parallel_for(jobs, leaving ? num_blocks - 1 : num_blocks, grain, [&](int begin, int end) {
        for (int b = begin; b < end; ++b) {
          project_block(pass, {b * kBlockRows, std::min((b + 1) * kBlockRows, plane_rows_), leaving});
        }
      });
    }
  }

  void finish(const XpbdSubstep& substep, JobSystem& jobs, ClothState& state) override {
    const FinishedRow row{grid_.num_columns(), plane_pitch_, substep.step, 1 / substep.step};
    const auto run = [&](const float* c, float* x, float* v) {
      for_rows(jobs, [&](int first, int at) { finish_row(row, c + at, x + first, v + first); });
    };
    run(c_.x, state.x.x(), state.v.x());
    run(c_.y, state.x.y(), state.v.y());
    run(c_.z, state.x.z(), state.v.z());
  }

 private:
  static constexpr int kArrays = 10;

  static int divide_up(int a, int b) { return (a + b - 1) / b; }

  static float* aligned(float* p) {
    constexpr std::uintptr_t kBytes = kPackLanes * sizeof(float);
    return p + (kBytes - reinterpret_cast<std::uintptr_t>(p) % kBytes) % kBytes / sizeof(float);
  }

  static void set(const Rows& rows, int at, const Vec3& value) {
    rows.x[at] = static_cast<float>(value.x());
    rows.y[at] = static_cast<float>(value.y());
    rows.z[at] = static_cast<float>(value.z());
  }

  /// The place of column i of row j.
  int place(int i, int j) const {
    const int plane = kClasses * (j % kClasses) + i % kClasses;
    return plane * plane_pitch_ + j / kClasses * pitch_ + i / kClasses;
  }
  int place(int particle) const {
    return place(particle % grid_.num_columns(), particle / grid_.num_columns());
  }

  /// body(first particle, its place) for each row of the grid.
  template <class Body>
  void for_rows(JobSystem& jobs, const Body& body) const {
    parallel_for(jobs, grid_.num_rows(), std::max(1, kGrain / grid_.num_columns()), [&](int begin, int end) {
      for (int j = begin; j < end; ++j) body(j * grid_.num_columns(), place(0, j));
    });
  }

  /// Masks of the places of a block with a neighbour `columns` further, −1 to 2, for each class of columns.
  void make_masks() {
    for (int columns = -1; columns <= 2; ++columns) {
      for (int r = 0; r < kClasses; ++r) {
        std::vector<float>& mask = masks_[columns + 1][r];
        mask.resize(static_cast<std::size_t>(kBlockRows) * pitch_);
        for (int i = 0; i < kBlockRows * pitch_; ++i) {
          const int column = kClasses * (i % pitch_) + r, end = column + columns;
          mask[i] = column < grid_.num_columns() && 0 <= end && end < grid_.num_columns() ? 1.0f : 0.0f;
        }
      }
    }
  }

  void make_strips(const ClothMaterial& m) {
    const double dx = grid_.spacing_x(), dz = grid_.spacing_z(), diagonal = std::sqrt(dx * dx + dz * dz);
    strips_.clear();
    add_strips(m, 1, 0, m.structural, dx);
    add_strips(m, 0, 1, m.structural, dz);
    add_strips(m, 1, 1, m.shear, diagonal);
    add_strips(m, -1, 1, m.shear, diagonal);
    add_strips(m, 2, 0, m.bend, 2 * dx);
    add_strips(m, 0, 2, m.bend, 2 * dz);
  }

  /// Adds the springs from each particle to the one `columns` and `rows` further. Every second class comes
  /// first, so that no direction of the cloth is preferred.
  void add_strips(const ClothMaterial& material, int columns, int rows, double stiffness,
                  double rest_length) {
    if (stiffness == 0 && material.damping == 0) return;
    for (const int s : {0, 2, 1, 3}) {
      for (const int r : {0, 2, 1, 3}) {
        if (columns * rows != 0 && !has_diagonal(r, s, columns)) continue;
        const int count =
            grid_.num_rows() - rows - s;  // rows from the class's first to the last that has one
        if (count <= 0) continue;
        const int row = (s + rows) / kClasses, column = (r + columns + kClasses) / kClasses - 1;
        const int plane = (s + rows) % kClasses * kClasses + (r + columns + kClasses) % kClasses;
        strips_.push_back({.from = (s * kClasses + r) * plane_pitch_,
                           .to = plane * plane_pitch_ + row * pitch_ + column,
                           .rows = divide_up(count, kClasses),
                           .leaves_row = row > 0,
                           .columns = column,
                           .exists = masks_[columns + 1][r].data(),
                           .stiffness = static_cast<float>(stiffness),
                           .rest_length = static_cast<float>(rest_length)});
      }
    }
  }

  /// Whether cells at columns of class r and rows of class s have the diagonal that starts there.
  bool has_diagonal(int r, int s, int columns) const {
    if (model_ == SpringModel::basic) return true;
    return is_main_diagonal(diagonals_of(model_), columns > 0 ? r : r - 1, s) == (columns > 0);
  }

  Grid grid_;
  SpringModel model_;
  int pitch_, plane_rows_;
  int plane_pitch_ = 0;
  std::vector<float> storage_;  // for all the arrays below
  Rows y_{}, c_{}, motion_{};
  float* inv_mass_ = nullptr;
  std::vector<float> masks_[4][kClasses];
  std::vector<Strip> strips_;
  float damping_ = 0;  // b of every spring [N·s/m]
};

}  // namespace

std::unique_ptr<ClothProjection> make_grid_projection(const ClothTopology& topology) {
  return std::make_unique<GridProjection>(topology);
}

}  // namespace weft::engine
