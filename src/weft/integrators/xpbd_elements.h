#pragma once
/// Private to integrators/: the pass of `xpbd` over the forces other than springs. Strains, their derivatives and
/// responses are those of the terms in forces/.
///
/// Each element is projected once: it moves its particles as a separate implicit Euler step of this element,
/// linearised at the present positions, would. As for springs this is XPBD with one iteration, with as many
/// simultaneous constraints as the element has strains. With B_c = ∂e/∂x_c, r_c the motion of corner c in the
/// substep so far, and τ the fabric's damping time:
///
///     membrane   K = h² A ∂s/∂e,  S = Σ_c B_c B_cᵀ/m_c     e strain of a patch, s its stress (forces/membrane_patch.h)
///                (1 + (1 + τ/h) K S) λ = h² A s + (τ/h) K Σ_c B_c r_c,          x_c −= B_cᵀ λ/m_c
///     bending    the same with one strain: the length of a stencil's curvature Σ w x
///                (fabric/bending_rows.h), or a hinge's angle (forces/hinge.h)
///     limit      of springs (fabric/membrane_law.h), without damping
///     collapse   of a patch's triangles, without damping: the narrowing along both axes (forces/collapse.h)
///     seam       the distance of its two points (forces/seam_springs.h)
///     gas        the volume, with all particles (forces/pressure.h)
///
/// The stress term of a membrane's Hessian is omitted, like that of springs.

#include <memory>

#include "weft/core/job_system.h"
#include "weft/integrators/xpbd_particles.h"
#include "weft/integrators/xpbd_projection.h"
#include "weft/model/cloth_model.h"

namespace weft::engine {

class XpbdElements {
 public:
  explicit XpbdElements(const ClothModel& model);

  /// Takes the numbers of another model of the same topology and elements.
  void set_numbers(const ClothModel& model);

  /// Projects every element once.
  void project(const XpbdSubstep& substep, JobSystem& jobs, XpbdParticles& particles);

 private:
  void colour_elements(const ClothElements& elements);
  void project_elements(const ClothElements& elements, double step, JobSystem& jobs,
                        XpbdParticles& particles) const;
  void project_gas(const Gas& gas, double step, XpbdParticles& particles);

  std::shared_ptr<const ClothTopology> topology_;
  std::shared_ptr<const ClothElements> elements_;  // null: none
  StrainLimit collapse_law_;
  double closed_seam_ = 0;    // r₀ [m]
  std::vector<int> limited_;  // springs that have the limit
  Colours patches_, stencils_, hinges_, limits_, seams_;
  std::vector<Vec3> gradient_;  // of the volume (num_particles) [m²]
};

}  // namespace weft::engine
