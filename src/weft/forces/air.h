#pragma once
/// Aerodynamic drag and lift of a triangle, and gusts.
///
///       n    lift          u = v_air − v: air velocity relative to the triangle of area A
///        \   ↑             c = |u·n|/|u|: 1 face-on, 0 edge-on
///     ----\--|--> drag
///      ____\_|___          F = ½ ρ A |u|² [ C_D c û  +  C_L c (n − (n·û) û) ],  n on the downstream side
///
/// so the force on a flat sheet is ½ ρ C_D A u² face-on, and zero edge-on. Lift is perpendicular to u and
/// does no work in still air; drag takes work from all motion against the air. The force is u times a
/// symmetric matrix, which depends on u and is positive semidefinite if C_L <= C_D:
///
///     F = G u,   G = ½ ρ A |u| [ (C_D c − C_L c²) I + C_L n nᵀ ]
///
/// With G from the start of a step and u from its end, a step of any length takes energy from the motion
/// against the air: light cloth stays stable.

#include "weft/core/vec.h"
#include "weft/wind.h"

namespace weft::engine {

/// G of a triangle [N·s/m]; `area_vector` is A n [m²], `slip` is u [m/s]. Zero if u is zero.
Mat3 air_matrix(const Air& air, const Vec3& area_vector, const Vec3& slip);

/// Gust velocity at a position and a time [m/s]. Continuous with its first and second derivatives.
Vec3 gust_velocity(const Gusts& gusts, const Vec3& place, double time);

}  // namespace weft::engine
