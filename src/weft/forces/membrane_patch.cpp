#include "weft/forces/membrane_patch.h"

#include <cmath>

namespace weft::engine {
namespace {

TriangleCorners triangle_of(const MembranePatch& patch, int t, const PatchCorners& x) {
  const auto& [a, b, c] = patch.corners[t];
  return {x[a], x[b], x[c]};
}

double share(const MembranePatch& patch, int t) { return patch.rest[t].area / patch.area(); }

/// Stress of each triangle, ∂W/∂e_t per its area.
std::array<Vec3, 2> stresses(const MembranePatch& patch, const MembraneResponse& mean,
                             const MembraneResponse& difference) {
  if (patch.num_triangles == 1) return {mean.stress, Vec3::Zero()};
  return {mean.stress + share(patch, 1) * difference.stress,
          mean.stress - share(patch, 0) * difference.stress};
}

}  // namespace

PatchCorners corners_of(const MembranePatch& patch, const std::vector<Vec3>& x) {
  PatchCorners corners;
  for (int v = 0; v < 4; ++v)
    corners[v] = v < patch.num_vertices() ? x[patch.vertices[v]] : Vec3(Vec3::Zero());
  return corners;
}

double difference_area(const MembranePatch& patch) {
  return patch.num_triangles == 1 ? 0.0 : patch.rest[0].area * share(patch, 1);
}

PatchStrain patch_strain(const MembranePatch& patch, const PatchCorners& x) {
  const Vec3 first = membrane_strain(patch.rest[0], triangle_of(patch, 0, x));
  if (patch.num_triangles == 1) return {first, Vec3::Zero()};
  const Vec3 second = membrane_strain(patch.rest[1], triangle_of(patch, 1, x));
  return {share(patch, 0) * first + share(patch, 1) * second, first - second};
}

PatchDerivative patch_strain_derivative(const MembranePatch& patch, const PatchCorners& x) {
  PatchDerivative result;
  result.mean.fill(Mat3::Zero());
  result.difference.fill(Mat3::Zero());
  for (int t = 0; t < patch.num_triangles; ++t) {
    const std::array<Mat3, 3> own = membrane_strain_derivative(patch.rest[t], triangle_of(patch, t, x));
    for (int c = 0; c < 3; ++c) {
      const int v = patch.corners[t][c];
      result.mean[v] += patch.num_triangles == 1 ? own[c] : Mat3(share(patch, t) * own[c]);
      if (patch.num_triangles == 2) result.difference[v] += (t == 0 ? 1 : -1) * own[c];
    }
  }
  return result;
}

double patch_energy(const MembranePatch& patch, const PatchLaw& law, const PatchCorners& x) {
  const PatchStrain strain = patch_strain(patch, x);
  const double mean = patch.area() * membrane_response(law.mean, strain.mean).energy;
  if (patch.num_triangles == 1) return mean;
  return mean + difference_area(patch) * difference_response(law.difference, strain.difference).energy;
}

PatchCorners patch_force(const MembranePatch& patch, const PatchLaw& law, const PatchCorners& x) {
  const PatchStrain strain = patch_strain(patch, x);
  const auto stress = stresses(patch, membrane_response(law.mean, strain.mean),
                               difference_response(law.difference, strain.difference));
  PatchCorners force;
  force.fill(Vec3::Zero());
  for (int t = 0; t < patch.num_triangles; ++t) {
    const TriangleCorners own = stress_force(patch.rest[t], stress[t], triangle_of(patch, t, x));
    for (int c = 0; c < 3; ++c) force[patch.corners[t][c]] += own[c];
  }
  return force;
}

PatchHessian patch_hessian(const MembranePatch& patch, const PatchLaw& law, const PatchCorners& x) {
  const PatchStrain strain = patch_strain(patch, x);
  const MembraneResponse mean = membrane_response(law.mean, strain.mean);
  const MembraneResponse difference = difference_response(law.difference, strain.difference);
  const PatchDerivative b = patch_strain_derivative(patch, x);
  PatchHessian hessian;
  for (int i = 0; i < patch.num_vertices(); ++i) {
    for (int j = 0; j < patch.num_vertices(); ++j) {
      Mat3& block = hessian.material[i][j];
      block = patch.area() * b.mean[i].transpose() * mean.tangent * b.mean[j];
      if (patch.num_triangles == 2)
        block += difference_area(patch) * b.difference[i].transpose() * difference.tangent * b.difference[j];
    }
  }
  const auto stress = stresses(patch, mean, difference);
  for (int t = 0; t < patch.num_triangles; ++t)
    hessian.edge_weight[t] = stress_weights(patch.rest[t], stress[t]);
  return hessian;
}

Mat3 patch_block(const MembranePatch& patch, const PatchHessian& hessian, int a, int b, StressFilter filter) {
  Mat3 block = hessian.material[a][b];
  for (int t = 0; t < patch.num_triangles; ++t) {
    int at_a = -1, at_b = -1;
    for (int c = 0; c < 3; ++c) {
      if (patch.corners[t][c] == a) at_a = c;
      if (patch.corners[t][c] == b) at_b = c;
    }
    if (at_a < 0 || at_b < 0) continue;
    block += stress_block(hessian.edge_weight[t], at_a, at_b, filter) * Mat3::Identity();
  }
  return block;
}

}  // namespace weft::engine
