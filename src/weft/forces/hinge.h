#pragma once
/// Bending hinge of two triangles about their common edge (discrete shells).
///
///             x2
///            /  \             θ: the angle between the triangles' normals, 0 where they are coplanar,
///           / 0  \            positive when folded towards the side of their normals
///         x0 ---- x1  e       (n0 ∝ e × (x2 − x0), n1 ∝ (x3 − x0) × e, e = x1 − x0: both up here)
///           \ 1  /
///            \  /             W = ½ k (θ − θ0)²,   k = hinge_stiffness()
///             x3
///
/// With k = D |e|²/(A0 + A1) a sheet bent to a cylinder around rows of edges stores ½ D κ² per area: exactly
/// the rigidity D [N·m]. Papers write the same energy with other constants: our D is D/6 in E. Grinspun et
/// al., Discrete Shells, SCA 2003; D/3 in M. Bergou et al., SGP 2006; 4D in R. Bridson et al., SCA 2003, and
/// ARCSim.
///
/// All functions take the four corners' positions [m].

#include <array>

#include "weft/core/vec.h"

namespace weft::engine {

using HingeCorners = std::array<Vec3, 4>;

/// D |e|²/(A0 + A1) [N·m] of the rest shape, for the rigidity D [N·m].
double hinge_stiffness(double rigidity, const HingeCorners& rest);

/// θ in (−π, π]; 0 if a triangle has zero area [rad].
double hinge_angle(const HingeCorners& x);

/// ∂θ/∂x_c [1/m]. Zero if a triangle has zero area, and limited to that of a triangle a thousandth as high as
/// its edge is long, so that a collapsed one does not eject its neighbours (only then, moments do not
/// balance).
HingeCorners hinge_angle_gradient(const HingeCorners& x);

/// ½ k (θ − θ0)² [J], θ − θ0 wrapped to the shorter way round.
double hinge_energy(double stiffness, double rest_angle, const HingeCorners& x);

/// Force on each corner: −k (θ − θ0) ∂θ/∂x_c [N]. Forces and their moments sum to zero.
HingeCorners hinge_force(double stiffness, double rest_angle, const HingeCorners& x);

/// Constant Hessian of a hinge that is flat at rest: k c_a c_b I for corners a and b, c = ∂θ/∂(height) at
/// rest (hinge_rest_weights). Positive semidefinite, assembled once, and as good in a Newton step as the
/// Gauss–Newton one.
std::array<double, 4> hinge_rest_weights(const HingeCorners& rest);

/// Gauss–Newton Hessian k (∂θ/∂x_a)(∂θ/∂x_b)ᵀ [N/m]: positive semidefinite.
Mat3 hinge_gauss_newton_block(double stiffness, const HingeCorners& gradient, int a, int b);

}  // namespace weft::engine
