#pragma once
/// Bending by curvature stencils (fabric/bending_rows.h): energy and force of the whole cloth, in double.

#include <vector>

#include "weft/core/vec.h"
#include "weft/fabric/bending_rows.h"

namespace weft::engine {

/// Σ_v w_rv x_v of a row: a second derivative of the positions [1/m].
Vec3 bending_curvature(const BendingRows& rows, int row, const std::vector<Vec3>& x);

/// ½ Σ_r k_r |Σ_v w_rv x_v|² [J]. Zero for flat cloth in any pose.
double bending_energy(const BendingRows& rows, const std::vector<Vec3>& x);

/// force_v −= k_r w_rv Σ_u w_ru x_u, for every row and vertex [N]. Forces and their moments sum to zero.
void add_bending_force(const BendingRows& rows, const std::vector<Vec3>& x, std::vector<Vec3>& force);

}  // namespace weft::engine
