#pragma once
/// Membranes that do not lock: strain smoothing over pairs of triangles.
///
/// A triangle with its own strain (forces/membrane.h) resists stretching with three constraints, and a mesh has
/// two triangles per vertex. That is twice as many constraints as degrees of freedom, so that stiff cloth can
/// fold along threads and edges only: it locks. A pair of triangles t, of areas A_t, has the strains' mean:
///
///     e = Σ A_t e_t/A,  A = Σ A_t        W = A w(e) + a v(d) + Σ A_t u(e_t),  d = e_0 − e_1,  a = A_0 A_1/A
///
/// w is the fabric's law without its strain limit u (fabric/membrane_law.h). v resists the difference with a fraction of the shear stiffness,
/// for a pair alone has motions without energy. With the full law for v, W would be the sum of the triangles'
/// energies. Uniform strain has no difference: it is resisted exactly as by single triangles. The mean is of Green
/// strains, not of displacements: a pair may fold along its edge.
///
/// Related: strain smoothing over cells (G. R. Liu et al., A smoothed finite element method for mechanics problems,
/// Computational Mechanics 39, 2007), and patches of triangles with a mean strain (J. Bonet, H. Marriott and O.
/// Hassan, An averaged nodal deformation gradient linear tetrahedral element, Commun. Numer. Meth. Engng 17, 2001).
///
/// All functions take the positions of the patch's vertices [m]; of a single triangle the fourth is not read.

#include <array>

#include "weft/fabric/elements.h"
#include "weft/fabric/membrane_law.h"
#include "weft/forces/membrane.h"

namespace weft::engine {

using PatchCorners = std::array<Vec3, 4>;

/// The positions of a patch's vertices among `x`.
PatchCorners corners_of(const MembranePatch& patch, const std::vector<Vec3>& x);

/// Green strains (ε11, ε22, 2 ε12) [1].
struct PatchStrain {
  Vec3 mean = Vec3::Zero();
  Vec3 difference = Vec3::Zero();  // of a pair
};
PatchStrain patch_strain(const MembranePatch& patch, const PatchCorners& x);

/// ∂/∂x_v of both for each vertex: three rows [1/m].
struct PatchDerivative {
  std::array<Mat3, 4> mean, difference;
};
PatchDerivative patch_strain_derivative(const MembranePatch& patch, const PatchCorners& x);

/// a [m²]; 0 of a single triangle.
double difference_area(const MembranePatch& patch);

/// W [J].
double patch_energy(const MembranePatch& patch, const PatchLaw& law, const PatchCorners& x);

/// Force of each triangle on its corners [N]. Forces of a triangle, and their moments, sum to zero.
std::array<TriangleCorners, 2> patch_triangle_forces(const MembranePatch& patch, const PatchLaw& law,
                                                     const PatchCorners& x);

/// Force on each vertex: the sum of its triangles' [N].
PatchCorners patch_force(const MembranePatch& patch, const PatchLaw& law, const PatchCorners& x);

/// Second derivatives of W, split as in MembraneHessian: the stress term is each triangle's own.
struct PatchHessian {
  std::array<std::array<Mat3, 4>, 4> material;            // [a][b] [N/m]
  std::array<std::array<double, 3>, 2> edge_weight = {};  // of a triangle, opposite to its corners [N/m]
};
PatchHessian patch_hessian(const MembranePatch& patch, const PatchLaw& law, const PatchCorners& x);

/// The 3×3 block of vertices a and b [N/m].
Mat3 patch_block(const MembranePatch& patch, const PatchHessian& hessian, int a, int b, StressFilter filter);

}  // namespace weft::engine
