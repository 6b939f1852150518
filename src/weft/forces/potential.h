#pragma once
/// The incremental potential of an implicit step, in floats, for the fast solver:
///
///     E(x) = ½ |x − y|²_D + Σ ½ k (l − l0)² + Σ ½ c |z_j − z_i|²  (along the spring if damping is projected)
///            + a fabric's membranes and bending (element_potential.h)
///
/// y is the prediction without springs, D = inertia and wind [N/m], z = x − y + (h/β) v_y with the velocity
/// v_y that belongs to y, and c = b β/h: the dissipation of spring damping at the new velocity
/// v_y + (β/h)(x − y).
///
/// Its Hessian is stored per spring as t I + w wᵀ with t = k min(1, |1 − l0/l|) and |w|² = k − t: positive
/// semidefinite by construction. The absolute value matters: with the transverse stiffness of compressed
/// springs clamped at zero, one Newton step overshoots sideways by hundreds of percent of strain.
///
/// Grids use stencils for springs; meshes use the NeighbourTable. Sums have one fixed order: the same bits
/// for any number of threads and any vector width.

#include <memory>
#include <vector>

#include "weft/core/aligned.h"
#include "weft/core/job_system.h"
#include "weft/core/padded_rows.h"
#include "weft/core/vec3_array.h"
#include "weft/forces/element_potential.h"
#include "weft/model/cloth_model.h"

namespace weft::engine {

namespace kernels {
struct GridPotential;
struct MeshPotential;
}  // namespace kernels

/// Layout of a cloth's particles in the solver's arrays.
PaddedRows padded_rows_of(const ClothTopology& topology);

class IncrementalPotential {
 public:
  /// Allocates the layout for the cloth, and copies its stiffnesses. `damping_rate` is β/h [1/s].
  void fit(const ClothModel& model, double damping_rate);

  const PaddedRows& rows() const { return rows_; }
  bool is_damped() const { return damping_ > 0 || damping_time_ > 0 || elements_.is_damped(); }

  // Set before use; zero in the padding (rows().size() each).
  std::vector<float> weight;  // D [N/m]
  Vec3Array target;           // y [m]
  Vec3Array velocity_offset;  // (h/β) v_y; only used with damping [m]

  /// Stores the positions before the step, and the displacement of the previous step, for the damping of
  /// elements (see ElementPotential). Call before a step.
  void remember(const Vec3Array& x, const Vec3Array& displacement, double memory, JobSystem& jobs);

  /// E(y + e) [J]. Offsets e from y, because they are small: in floats x − y would lose digits in small
  /// steps.
  double energy(const Vec3Array& e, JobSystem& jobs);

  /// E(y + e) [J], its force −∂E/∂x [N], and its Hessian, stored for multiply().
  double linearise(const Vec3Array& e, JobSystem& jobs, Vec3Array& force);

  /// y + e at the last energy() or linearise() [m].
  const Vec3Array& positions() const { return x_; }

  /// Whether the cloth can exceed the stiffness of C or its springs: by a strain limit or stretch curves.
  bool stiffens() const { return has_spring_limit() || elements_.stiffens(); }

  /// The stiffness added at the last linearise(), for each of the elements' couplings, or each spring where
  /// springs are the membranes; false: none [N/m].
  bool compute_stiffening(std::vector<double>& added) const;

  /// Whether a stretch at the last energy() or linearise() exceeds the strain limit by more than a solver may
  /// leave.
  bool is_beyond_limit() const;

  /// q = A p with the Hessian A of linearise(), and p·q. p must be zero in the padding.
  double multiply(const Vec3Array& p, JobSystem& jobs, Vec3Array& q);

 private:
  bool has_spring_limit() const { return spring_limit_.stiffness > 0; }
  void lay_out(const ClothModel& model);
  void fit_grid(const ClothModel& model);
  void spread_grid_stiffness(const ClothModel& model);
  void fit_mesh(const ClothModel& model);
  kernels::GridPotential grid_view(const Vec3Array& e);
  kernels::MeshPotential mesh_view(const Vec3Array& e);
  double compute(const Vec3Array& e, JobSystem& jobs, Vec3Array* force);
  double multiply_springs(const Vec3Array& p, JobSystem& jobs, Vec3Array& q);
  void place(const Vec3Array& e, JobSystem& jobs);
  double sum_parts(int count) const;

  std::shared_ptr<const ClothTopology> topology_;
  std::uint64_t model_id_ = 0;
  PaddedRows rows_;
  int num_families_ = 0;       // of equal springs on a grid; 0 if none has any stiffness
  float stiffness_[6] = {};    // of each family [N/m]
  float rest_length_[6] = {};  // of each family [m]
  std::vector<float>
      grid_stiffness_;  // of each spring of a grid, in slope_'s order; empty: its family's [N/m]
  std::vector<float> mesh_stiffness_;  // of each entry of the table [N/m]
  float damping_ = 0;                  // c [N/m]
  float damping_time_ = 0;             // stiffness-proportional damping: c of a spring over its stiffness [1]
  bool is_projected_ = true;

  AlignedFloats hessian_;      // t, wx, wy, wz of each spring
  AlignedFloats slope_;        // k (1 − l0/l) and damping: the force is slope · (x_j − x_i)
  StrainLimit spring_limit_;   // on a grid
  std::vector<float> peak_;    // with a limit: largest strain of each row's springs [1]
  Vec3Array x_;                // y + e
  Vec3Array damped_;           // z
  std::vector<double> parts_;  // sums of rows or slices
  NeighbourTable no_springs_;  // on a mesh whose springs have no stiffness
  bool has_springs_ = true;
  bool has_soft_border_ = false;  // on a grid
  ElementPotential elements_;
};

}  // namespace weft::engine
