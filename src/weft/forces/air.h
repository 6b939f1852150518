#pragma once
/// Drag and lift of the air on a triangle, and gusts.
///
///       n    lift          u = v_air − v: how the air passes the triangle of area A
///        \   ↑             c = |u·n|/|u|: 1 face-on, 0 edge-on
///     ----\--|--> drag
///      ____\_|___          F = ½ ρ A |u|² [ C_D c û  +  C_L c (n − (n·û) û) ],  n on the side the air goes
///      to
///
/// so a flat sheet face-on feels ½ ρ C_D A u², and one that is edge-on nothing. Lift is perpendicular to u
/// and does no work in still air; drag takes work from all motion against the air. This is linear in u but
/// for a matrix that is symmetric, and positive semidefinite as long as C_L <= C_D:
///
///     F = G u,   G = ½ ρ A |u| [ (C_D c − C_L c²) I + C_L n nᵀ ]
///
/// With G from the start of a step and u from its end a step takes energy from the motion against the air,
/// whatever its length: no light cloth is blown up by it.

#include "weft/core/vec.h"
#include "weft/wind.h"

namespace weft::engine {

/// G of a triangle [N·s/m]; `area_vector` is A n [m²], `slip` is u [m/s]. Zero without slip.
Mat3 air_matrix(const Air& air, const Vec3& area_vector, const Vec3& slip);

/// At a place of the world and a time [m/s]. Continuous with its first and second derivatives.
Vec3 gust_velocity(const Gusts& gusts, const Vec3& place, double time);

}  // namespace weft::engine
