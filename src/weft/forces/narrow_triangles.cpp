#include "weft/forces/narrow_triangles.h"

#include <algorithm>
#include <utility>

#include "weft/forces/pack3.h"

namespace weft::engine {
namespace {

using kernels::ConstRows;
using kernels::dot;
using kernels::gather3;
using kernels::load3;
using kernels::minus;
using kernels::Three;

constexpr int kGrain = 4096;  // triangles per chunk of work, about
constexpr int kLanes = kPackLanes;

/// Score: not positive if G − tR is not positive definite; `r` are t R11, t R12, t R22.
template <int W>
WEFT_ALWAYS_INLINE Pack<W> score_of(const Three<W>& d1, const Three<W>& d2, const Three<W>& r) {
  const Pack<W> p = dot<W>(d1, d1) - r.x, c = dot<W>(d1, d2) - r.y, q = dot<W>(d2, d2) - r.z;
  return smaller(p, p * q - c * c);
}

struct GridTriangles {
  PaddedRows rows;
  bool alternates;
  float xx, zz;  // t dx², t dz² [m²]
  ConstRows x;
  float *score, *least;
};

/// Legs of a cell's triangles as in GridElements: along x and z from the right angle, up to sign.
template <int W, bool kAlternates>
WEFT_ALWAYS_INLINE void score_rows(const GridTriangles& g, int row_begin, int row_end) {
  const std::ptrdiff_t pitch = g.rows.stride(), plane = static_cast<std::ptrdiff_t>(g.rows.size());
  const Three<W> rest{broadcast<W>(g.xx), broadcast<W>(0), broadcast<W>(g.zz)};
  for (int j = row_begin; j < row_end; ++j) {
    Pack<W> least = broadcast<W>(1);
    for_packs<W>(g.rows.row_length - 1, [&](std::ptrdiff_t i, int) WEFT_INLINE_LAMBDA {
      const std::ptrdiff_t at = g.rows.row(j) + i;
      const Three<W> a = load3<W>(g.x, at), b = load3<W>(g.x, at + 1), c = load3<W>(g.x, at + pitch),
                     d = load3<W>(g.x, at + pitch + 1);
      const Three<W> h0 = minus<W>(b, a), h1 = minus<W>(d, c), v0 = minus<W>(c, a), v1 = minus<W>(d, b);
      Pack<W> top = score_of<W>(h0, v1, rest), bottom = score_of<W>(h1, v0, rest);
      if (kAlternates) {
        const Mask<W> is_main = even_from<W>(i + j);
        top = blend<W>(is_main, top, score_of<W>(h0, v0, rest));
        bottom = blend<W>(is_main, bottom, score_of<W>(h1, v1, rest));
      }
      const Pack<W> exists = count_below<W>(g.rows.row_length - 1, i), none = 1.0f - exists;
      top = exists * top + none;
      bottom = exists * bottom + none;
      store(g.score + at, top);
      store(g.score + plane + at, bottom);
      least = smaller(least, smaller(top, bottom));
    });
    g.least[j] = 0.0f - widest<W>(0.0f - least);
  }
}

template <int W>
WEFT_ALWAYS_INLINE void score_grid_body(const GridTriangles& g, int row_begin, int row_end) {
  if (g.alternates) return score_rows<W, true>(g, row_begin, row_end);
  score_rows<W, false>(g, row_begin, row_end);
}

WEFT_MULTIVERSION_PACKS(score_grid, (const GridTriangles& g, int row_begin, int row_end),
                        (g, row_begin, row_end))

struct MeshTriangles {
  int first;          // index of particle 0
  const int* corner;  // three of each triangle
  const float* rest;  // per triangle
  ConstRows x;
  float *score, *least;
};

template <int W>
WEFT_ALWAYS_INLINE void score_mesh_body(const MeshTriangles& m, int slice_begin, int slice_end) {
  for (int slice = slice_begin; slice < slice_end; ++slice) {
    Pack<W> least = broadcast<W>(1);
    for (int lane = 0; lane < kLanes; lane += W) {
      const int* corner = m.corner + 3 * kLanes * static_cast<std::ptrdiff_t>(slice) + lane;
      const float* rest = m.rest + 3 * kLanes * static_cast<std::ptrdiff_t>(slice) + lane;
      const Three<W> x0 = gather3<W>(m.x, m.first, corner);
      const Three<W> d1 = minus<W>(gather3<W>(m.x, m.first, corner + kLanes), x0);
      const Three<W> d2 = minus<W>(gather3<W>(m.x, m.first, corner + 2 * kLanes), x0);
      const Pack<W> score = score_of<W>(d1, d2, load3<W>({rest, rest + kLanes, rest + 2 * kLanes}, 0));
      store(m.score + kLanes * static_cast<std::ptrdiff_t>(slice) + lane, score);
      least = smaller(least, score);
    }
    m.least[slice] = 0.0f - widest<W>(0.0f - least);
  }
}

WEFT_MULTIVERSION_PACKS(score_mesh, (const MeshTriangles& m, int slice_begin, int slice_end),
                        (m, slice_begin, slice_end))

}  // namespace

void NarrowTriangles::fit(std::shared_ptr<const ClothTopology> topology, const PaddedRows& rows,
                          double bound) {
  if (topology == topology_ && rows == rows_ && bound == bound_) return;
  topology_ = std::move(topology);
  rows_ = rows;
  bound_ = bound;
  if (!topology_->grid) return fit_mesh();
  score_.assign(2 * rows_.size() + kPackLanes, 1.0f);
  least_.assign(rows_.num_rows - 1, 1.0f);
}

void NarrowTriangles::fit_mesh() {
  const RestMesh& mesh = topology_->mesh;
  const int num_slices = round_up_to_pack(mesh.num_triangles()) / kLanes;
  corner_.assign(3 * kLanes * num_slices, 0);
  rest_.assign(3 * kLanes * num_slices, 0.0f);
  for (int t = 0; t < num_slices * kLanes; ++t) {
    const auto at = [&](int k) {
      return static_cast<std::size_t>(3 * (t / kLanes) + k) * kLanes + t % kLanes;
    };
    rest_[at(0)] = rest_[at(2)] = -1;  // wide where there is no triangle
    if (t >= mesh.num_triangles()) continue;
    const TriangleCorners rest = mesh.corners(t);
    const Vec3 d1 = rest[1] - rest[0], d2 = rest[2] - rest[0];
    const double gram[] = {d1.squaredNorm(), d1.dot(d2), d2.squaredNorm()};
    for (int k = 0; k < 3; ++k) {
      corner_[at(k)] = mesh.triangles[t][k];
      rest_[at(k)] = static_cast<float>(bound_ * bound_ * gram[k]);
    }
  }
  score_.assign(kLanes * num_slices, 1.0f);
  least_.assign(num_slices, 1.0f);
}

const std::vector<int>& NarrowTriangles::find(const Vec3Array& x, JobSystem& jobs) {
  found_.clear();
  if (topology_->grid) {
    find_on_grid(x, jobs);
  } else {
    find_on_mesh(x, jobs);
  }
  return found_;
}

void NarrowTriangles::find_on_grid(const Vec3Array& x, JobSystem& jobs) {
  const Grid& grid = *topology_->grid;
  const double t = bound_ * bound_;
  const GridTriangles g{.rows = rows_,
                        .alternates = diagonals_of(topology_->spring_model) == GridDiagonals::alternating,
                        .xx = static_cast<float>(t * grid.spacing_x() * grid.spacing_x()),
                        .zz = static_cast<float>(t * grid.spacing_z() * grid.spacing_z()),
                        .x = kernels::rows(x),
                        .score = score_.data(),
                        .least = least_.data()};
  parallel_for(jobs, grid.cells_z, std::max(1, kGrain / rows_.row_length),
               [&](int begin, int end) { score_grid(g, begin, end); });
  for (int j = 0; j < grid.cells_z; ++j) {
    if (least_[j] > 0) continue;
    for (int i = 0; i < grid.cells_x; ++i) {
      const std::size_t top = rows_.row(j) + i, bottom = rows_.size() + top;
      const bool is_main = is_main_diagonal(diagonals_of(topology_->spring_model), i, j);
      const int cell =
          j * grid.cells_x + i;  // the mesh lists the bottom first where the cut is along the main diagonal
      if (score_[is_main ? bottom : top] <= 0) found_.push_back(2 * cell);
      if (score_[is_main ? top : bottom] <= 0) found_.push_back(2 * cell + 1);
    }
  }
}

void NarrowTriangles::find_on_mesh(const Vec3Array& x, JobSystem& jobs) {
  const MeshTriangles m{.first = rows_.row(0),
                        .corner = corner_.data(),
                        .rest = rest_.data(),
                        .x = kernels::rows(x),
                        .score = score_.data(),
                        .least = least_.data()};
  const int num_slices = static_cast<int>(least_.size());
  parallel_for(jobs, num_slices, kGrain / kLanes, [&](int begin, int end) { score_mesh(m, begin, end); });
  for (int slice = 0; slice < num_slices; ++slice) {
    if (least_[slice] > 0) continue;
    for (int t = slice * kLanes; t < (slice + 1) * kLanes; ++t) {
      if (score_[t] <= 0) found_.push_back(t);
    }
  }
}

}  // namespace weft::engine
