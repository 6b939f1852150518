#pragma once
/// Narrow triangles: those with a smaller principal stretch below a bound, by one pass over all, in floats.
///
/// G is the Gram matrix of the two edges from one corner, R the same at rest. σ2² is the smallest root of
/// det(G − λR), and exceeds t exactly if G − tR is positive definite: a test without roots and frames.

#include <memory>
#include <vector>

#include "weft/core/aligned.h"
#include "weft/core/job_system.h"
#include "weft/core/padded_rows.h"
#include "weft/core/vec3_array.h"
#include "weft/model/cloth_model.h"

namespace weft::engine {

class NarrowTriangles {
 public:
  /// Allocates the layout for the cloth; `bound` > 0 [1].
  void fit(std::shared_ptr<const ClothTopology> topology, const PaddedRows& rows, double bound);

  /// Indices of narrow triangles, ascending. Positions are laid out by the rows. The result is the same for
  /// any number of threads and any vector width.
  const std::vector<int>& find(const Vec3Array& x, JobSystem& jobs);

 private:
  void fit_mesh();
  void find_on_grid(const Vec3Array& x, JobSystem& jobs);
  void find_on_mesh(const Vec3Array& x, JobSystem& jobs);

  std::shared_ptr<const ClothTopology> topology_;
  PaddedRows rows_;
  double bound_ = 0;
  std::vector<int> corner_;  // of a mesh: three of each triangle, in slices of sixteen
  AlignedFloats rest_;       // of each: t R11, t R12, t R22 [m²]
  AlignedFloats score_;  // > 0 where G − tR is positive definite: of a grid's tops and bottoms, or of slices
  std::vector<float> least_;  // score of each row or slice
  std::vector<int> found_;
};

}  // namespace weft::engine
