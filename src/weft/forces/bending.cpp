#include "weft/forces/bending.h"

namespace weft::engine {
Vec3 bending_curvature(const BendingRows& rows, int row, const std::vector<Vec3>& x) {
  // Differences from the row's first vertex: the same accuracy at any position of the cloth.
  const Vec3 origin = x[rows.vertex[rows.begin[row]]];
  Vec3 sum = Vec3::Zero();
  for (int k = rows.begin[row] + 1; k < rows.begin[row + 1]; ++k) {
    sum += rows.weight[k] * (x[rows.vertex[k]] - origin);
  }
  return sum;
}

double bending_energy(const BendingRows& rows, const std::vector<Vec3>& x) {
  double energy = 0;
  for (int r = 0; r < rows.num_rows(); ++r) {
    energy += 0.5 * rows.stiffness[r] * bending_curvature(rows, r, x).squaredNorm();
  }
  return energy;
}

void add_bending_force(const BendingRows& rows, const std::vector<Vec3>& x, std::vector<Vec3>& force) {
  for (int r = 0; r < rows.num_rows(); ++r) {
    const Vec3 moment = rows.stiffness[r] * bending_curvature(rows, r, x);
    for (int k = rows.begin[r]; k < rows.begin[r + 1]; ++k) force[rows.vertex[k]] -= rows.weight[k] * moment;
  }
}

}  // namespace weft::engine
