#include "weft/forces/membrane_patch.h"

#include <cmath>

namespace weft::engine {
namespace {

TriangleCorners triangle_of(const MembranePatch& patch, int t, const PatchCorners& x) {
  const auto& [a, b, c] = patch.corners[t];
  return {x[a], x[b], x[c]};
}

double share(const MembranePatch& patch, int t) { return patch.rest[t].area / patch.area(); }

std::array<Vec3, 2> triangle_strains(const MembranePatch& patch, const PatchCorners& x) {
  std::array<Vec3, 2> strains = {Vec3::Zero(), Vec3::Zero()};
  for (int t = 0; t < patch.num_triangles; ++t)
    strains[t] = membrane_strain(patch.rest[t], triangle_of(patch, t, x));
  return strains;
}

PatchStrain combine(const MembranePatch& patch, const std::array<Vec3, 2>& strains) {
  if (patch.num_triangles == 1) return {strains[0], Vec3::Zero()};
  return {share(patch, 0) * strains[0] + share(patch, 1) * strains[1], strains[0] - strains[1]};
}

/// Responses of a patch's strains.
struct Response {
  MembraneResponse mean, difference;
  std::array<MembraneResponse, 2> limit;  // of a pair's triangles
};

Response respond(const MembranePatch& patch, const PatchLaw& law, const PatchCorners& x) {
  const std::array<Vec3, 2> strains = triangle_strains(patch, x);
  if (patch.num_triangles == 1) return {membrane_response(law.alone, strains[0]), {}, {}};
  const PatchStrain both = combine(patch, strains);
  Response response{
      membrane_response(law.mean, both.mean), difference_response(law.difference, both.difference), {}};
  if (law.limit.limit.stiffness > 0)
    response.limit = {membrane_response(law.limit, strains[0]), membrane_response(law.limit, strains[1])};
  return response;
}

/// Stress of each triangle, ∂W/∂e_t per its area.
std::array<Vec3, 2> stresses(const MembranePatch& patch, const Response& response) {
  if (patch.num_triangles == 1) return {response.mean.stress, Vec3::Zero()};
  return {response.mean.stress + share(patch, 1) * response.difference.stress + response.limit[0].stress,
          response.mean.stress - share(patch, 0) * response.difference.stress + response.limit[1].stress};
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
  return combine(patch, triangle_strains(patch, x));
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
  const Response response = respond(patch, law, x);
  double energy = patch.area() * response.mean.energy;
  if (patch.num_triangles == 2) energy += difference_area(patch) * response.difference.energy;
  for (int t = 0; t < patch.num_triangles; ++t) energy += patch.rest[t].area * response.limit[t].energy;
  return energy;
}

std::array<TriangleCorners, 2> patch_triangle_forces(const MembranePatch& patch, const PatchLaw& law,
                                                     const PatchCorners& x) {
  const auto stress = stresses(patch, respond(patch, law, x));
  std::array<TriangleCorners, 2> force;
  for (int t = 0; t < patch.num_triangles; ++t)
    force[t] = stress_force(patch.rest[t], stress[t], triangle_of(patch, t, x));
  return force;
}

PatchCorners patch_force(const MembranePatch& patch, const PatchLaw& law, const PatchCorners& x) {
  const auto own = patch_triangle_forces(patch, law, x);
  PatchCorners force;
  force.fill(Vec3::Zero());
  for (int t = 0; t < patch.num_triangles; ++t) {
    for (int c = 0; c < 3; ++c) force[patch.corners[t][c]] += own[t][c];
  }
  return force;
}

PatchHessian patch_hessian(const MembranePatch& patch, const PatchLaw& law, const PatchCorners& x) {
  const Response response = respond(patch, law, x);
  const PatchDerivative b = patch_strain_derivative(patch, x);
  PatchHessian hessian;
  for (int i = 0; i < patch.num_vertices(); ++i) {
    for (int j = 0; j < patch.num_vertices(); ++j) {
      Mat3& block = hessian.material[i][j];
      block = patch.area() * b.mean[i].transpose() * response.mean.tangent * b.mean[j];
      if (patch.num_triangles == 2)
        block += difference_area(patch) * b.difference[i].transpose() * response.difference.tangent *
                 b.difference[j];
    }
  }
  const auto stress = stresses(patch, response);
  for (int t = 0; t < patch.num_triangles; ++t) {
    hessian.edge_weight[t] = stress_weights(patch.rest[t], stress[t]);
    if (response.limit[t].tangent.isZero(0)) continue;
    const auto own = membrane_strain_derivative(patch.rest[t], triangle_of(patch, t, x));
    for (int c = 0; c < 3; ++c) {
      for (int d = 0; d < 3; ++d)
        hessian.material[patch.corners[t][c]][patch.corners[t][d]] +=
            patch.rest[t].area * own[c].transpose() * response.limit[t].tangent * own[d];
    }
  }
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
