#pragma once
/// A fabric's elements in the incremental potential of the fast solver, in floats:
///
///     Σ ½ A (eᵀ C e + η δeᵀ C δe) + ½ Σ b_ij (|x_j − x_i|² + η |z_j − z_i|²),      η = τ β/h
///
/// e is the Green strain of a grid's triangle or of a mesh's patch (forces/membrane_patch.h) with its difference, and δe its change in a step with β (see remember()): zero for rigid
/// motions. Both squares of a triangle combine to ½ (1 + η) A (e − e*)ᵀ C (e − e*) and a constant, which is
/// omitted. The second sum is bending by stencils (fabric/bending_rows.h), whose quadratic form has the
/// constant couplings b_ij; z = x − y + (h/β) v_y as in potential.h. Its damping acts on the full relative
/// velocity: a rigidly spinning curl of curvature κ loses by it the share 2 τ D κ²/(ρ r²) of its energy per
/// second, r being its radius of gyration.
///
/// The Hessian is stored as one 3×3 block per edge: the exact material term, the stress term as three scalar
/// edge weights per triangle with absolute values, the exact bending: positive semidefinite.
///
/// Grids use stencils; meshes use tables of the particles' edges. Sums have one fixed order: the same bits
/// for any number of threads and any vector width.

#include <memory>
#include <vector>

#include "weft/core/aligned.h"
#include "weft/core/job_system.h"
#include "weft/core/padded_rows.h"
#include "weft/core/vec3_array.h"
#include "weft/forces/element_tables.h"
#include "weft/model/cloth_model.h"

namespace weft::engine {

namespace kernels {
struct GridElements;
struct MeshElements;
}  // namespace kernels

/// Contribution of a triangle's stiffness to a coupling: `share` of it. On a mesh it is that of its patch.
struct TriangleCoupling {
  int coupling = 0, triangle = 0;
  double share = 0;  // cotangent weight [1]
};

class ElementPotential {
 public:
  /// Allocates the layout for the cloth's elements; there may be none. `damping_rate` is β/h [1/s]. Throws
  /// InputError for hinges, and for a grid whose warp is along neither axis.
  void fit(const ClothModel& model, const PaddedRows& rows, double damping_rate);

  bool empty() const { return elements_ == nullptr; }
  bool is_damped() const { return damping_ > 0; }
  bool has_limit() const { return elements_ != nullptr && elements_->limit.stiffness > 0; }
  const StrainLimit& limit() const { return elements_->limit; }
  bool stiffens() const { return has_limit() || (elements_ != nullptr && elements_->has_curves()); }

  /// Largest principal stretch minus one, at the last energy() or linearise(); only with a limit [1].
  double peak_strain() const;

  /// Stiffness that limit and curves add to each of the elements' couplings at the last linearise(), as C
  /// contributes to the couplings themselves; false: none [N/m].
  bool compute_stiffer_couplings(std::vector<double>& added) const;

  /// Stores the strains e₀ and e₋₁ at the starts of this step and of the previous one; δe = e − e₀ − memory
  /// (e₀ − e₋₁). Positions are laid out by the rows. Call before a damped step.
  void remember(const Vec3Array& start, const Vec3Array& before, double memory, JobSystem& jobs);

  /// Value at x [J]; `z` is read only with damping.
  double energy(const Vec3Array& x, const Vec3Array& z, JobSystem& jobs);

  /// Value at x; adds the force to `force` [N], and stores the Hessian.
  double linearise(const Vec3Array& x, const Vec3Array& z, JobSystem& jobs, Vec3Array& force);

  /// q += A p with the Hessian A of linearise(), and p·A p. p must be zero in the padding.
  double multiply(const Vec3Array& p, JobSystem& jobs, Vec3Array& q);

 private:
  void fit_grid(const ClothModel& model);
  void fit_mesh(const ClothModel& model);
  kernels::GridElements grid_view();
  kernels::MeshElements mesh_view();
  void add_past(const Vec3Array& x, double share, JobSystem& jobs);
  double sum_parts(int count) const;

  std::shared_ptr<const ClothElements> elements_;
  std::shared_ptr<const ClothTopology> topology_;
  PaddedRows rows_;
  bool is_grid_ = true;
  void fit_stiffening(std::size_t num_tangents, std::size_t num_peaks);
  double stiffening_rate(int triangle) const;

  float damping_ = 0;      // η
  AlignedFloats bending_;  // on a grid, couplings of each family [N/m]
  ElementTables tables_;   // on a mesh
  AlignedFloats past_;     // η/(1 + η) times the strain without δe: e*
  AlignedFloats stress_;   // on a grid; on a mesh also the frames
  AlignedFloats patch_;    // on a mesh, slopes and blocks of the patches' couplings
  AlignedFloats slope_;
  AlignedFloats tangent_, peak_;  // of stiffening
  std::vector<TriangleCoupling> triangle_couplings_;
  AlignedFloats hessian_;
  Vec3Array bent_;             // x + η z
  std::vector<double> parts_;  // sums of rows or slices
};

}  // namespace weft::engine
