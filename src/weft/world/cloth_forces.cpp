#include "weft/world/cloth_forces.h"

#include <array>

#include "weft/forces/bending.h"
#include "weft/forces/collapse.h"
#include "weft/forces/damping.h"
#include "weft/forces/hinge.h"
#include "weft/forces/membrane_patch.h"
#include "weft/forces/pressure.h"
#include "weft/forces/seam_springs.h"
#include "weft/forces/spring.h"
#include "weft/forces/thread_bends.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

std::vector<Vec3> to_vectors(const Vec3Array& values) {
  std::vector<Vec3> vectors;
  for (std::size_t i = 0; i < values.size(); ++i) vectors.push_back(values.get(i));
  return vectors;
}

/// The values of an element's vertices.
template <std::size_t N>
std::array<Vec3, N> gather(const std::array<int, N>& vertices, const std::vector<Vec3>& values) {
  std::array<Vec3, N> own;
  for (std::size_t k = 0; k < N; ++k) own[k] = values[vertices[k]];
  return own;
}

template <std::size_t N>
void scatter(const std::array<int, N>& vertices, const std::array<Vec3, N>& own, std::vector<Vec3>& force) {
  for (std::size_t k = 0; k < N; ++k) force[vertices[k]] += own[k];
}

void add_patch_forces(const MembranePatch& patch, const PatchCorners& own, std::vector<Vec3>& force) {
  for (int k = 0; k < patch.num_vertices(); ++k) force[patch.vertices[k]] += own[k];
}

void add_elastic_forces(const ClothElements& elements, const std::vector<Vec3>& x, std::vector<Vec3>& force) {
  add_bending_force(elements.bending, x, force);
  const PatchLaw law = elements.law();
  for (const MembranePatch& patch : elements.patches)
    add_patch_forces(patch, patch_force(patch, law, corners_of(patch, x)), force);
  for (const HingeElement& h : elements.hinges)
    scatter(h.vertices, hinge_force(h.stiffness, 0, gather(h.vertices, x)), force);
}

/// −τ A Bᵀ C B v, B the derivative of the mean strain, and the same of the difference.
void add_membrane_damping(const ClothElements& elements, const std::vector<Vec3>& x,
                          const std::vector<Vec3>& v, std::vector<Vec3>& force) {
  for (const MembranePatch& patch : elements.patches) {
    const PatchDerivative derivative = patch_strain_derivative(patch, corners_of(patch, x));
    const PatchCorners velocity = corners_of(patch, v);
    Vec3 mean = Vec3::Zero(), difference = Vec3::Zero();
    for (int k = 0; k < patch.num_vertices(); ++k) {
      mean += derivative.mean[k] * velocity[k];
      difference += derivative.difference[k] * velocity[k];
    }
    const Vec3 stress = elements.damping * patch.area() * (elements.stiffness * mean);
    const Vec3 other = elements.damping * difference_area(patch) * elements.difference.stiffness * difference;
    PatchCorners pull;
    for (int k = 0; k < 4; ++k)
      pull[k] = -(derivative.mean[k].transpose() * stress + derivative.difference[k].transpose() * other);
    add_patch_forces(patch, pull, force);
  }
}

/// −τ k times the rate of the curvature's length, and of the hinges' angles.
void add_bending_damping(const ClothElements& elements, const std::vector<Vec3>& x,
                         const std::vector<Vec3>& v, std::vector<Vec3>& force) {
  const BendingRows& rows = elements.bending;
  for (int r = 0; r < rows.num_rows(); ++r) {
    const Vec3 curvature = bending_curvature(rows, r, x);
    if (curvature.isZero(0)) continue;
    const Vec3 direction = curvature.normalized();
    const double moment = elements.damping * rows.stiffness[r] * direction.dot(bending_curvature(rows, r, v));
    for (int k = rows.begin[r]; k < rows.begin[r + 1]; ++k)
      force[rows.vertex[k]] -= moment * rows.weight[k] * direction;
  }
  for (const HingeElement& h : elements.hinges) {
    const HingeCorners gradient = hinge_angle_gradient(gather(h.vertices, x));
    double rate = 0;
    for (int k = 0; k < 4; ++k) rate += gradient[k].dot(v[h.vertices[k]]);
    for (int k = 0; k < 4; ++k) force[h.vertices[k]] -= elements.damping * h.stiffness * rate * gradient[k];
  }
}

/// Drag and lift on each particle: triangles at their start positions, with the end's velocities, as in the
/// integrators (forces/air.h).
void add_air_forces(const ClothModel& model, const ClothState& before, const ClothState& after,
                    const Wind& wind, double time, std::vector<Vec3>& force) {
  std::vector<Vec3> air;
  for (int i = 0; i < model.num_particles(); ++i)
    air.push_back(wind.velocity + gust_velocity(wind.gusts, before.position(i), time));
  for (const Triangle& triangle : model.topology->mesh.triangles) {
    const auto& [a, b, c] = triangle;
    const Vec3 xa = before.x.get(a), area = 0.5 * (before.x.get(b) - xa).cross(before.x.get(c) - xa);
    Vec3 slip = Vec3::Zero();
    for (const int v : triangle) slip += (air[v] - before.v.get(v)) / 3;
    const Mat3 third = air_matrix(wind.air, area, slip) / 3;
    for (const int v : triangle) force[v] += third * (air[v] - after.v.get(v));
  }
}

}  // namespace

std::vector<Vec3> compute_elastic_forces(const ClothModel& model, const ClothState& state) {
  std::vector<Vec3> force(state.x.size(), Vec3::Zero());
  if (model.elements) add_elastic_forces(*model.elements, to_vectors(state.x), force);
  add_thread_bend_force(model, state, force);
  const StrainLimit limit = model.elements ? model.elements->spring_limit : StrainLimit();
  for (int s = 0; s < static_cast<int>(model.topology->springs.size()); ++s) {
    const auto& [i, j, kind, rest_length] = model.topology->springs[s];
    const Vec3 d = state.x.get(j) - state.x.get(i);
    const double length = d.norm();
    Vec3 pull = spring_force(model.stiffness(s), rest_length, d);
    if (kind != SpringKind::bend && length > 0)
      pull += limit_response(limit, length / rest_length - 1).tension / length * d;
    force[i] += pull;
    force[j] -= pull;
  }
  const StrainLimit collapse = make_collapse_law(model);
  const RestMesh& mesh = model.topology->mesh;
  const std::vector<Vec3> x = to_vectors(state.x);
  for (int t = 0; t < mesh.num_triangles(); ++t)
    scatter(mesh.triangles[t],
            collapse_force(make_rest_triangle(mesh, t), collapse, gather(mesh.triangles[t], x)), force);
  visit_seam_pulls(
      model, seam_opening(model, state), [&](int v) { return x[v]; },
      [&](const SeamSpring& spring, const SeamPull& pull) {
        const auto weights = spring.weights();
        for (int k = 0; k < 3; ++k) force[spring.particles[k]] += weights[k] * pull.force;
      });
  if (!model.gas.is_active()) return force;
  const double excess = model.gas.orientation * gas_excess(model.gas, compute_volume(model, state));
  add_volume_gradient(
      mesh.triangles, [&](int v) { return x[v]; },
      [&](int v, const Vec3& part) { force[v] += excess * part; });
  return force;
}

std::vector<Vec3> compute_damping_forces(const ClothModel& model, const ClothState& state) {
  std::vector<Vec3> force(state.x.size(), Vec3::Zero());
  if (model.elements && model.elements->damping > 0) {
    const std::vector<Vec3> x = to_vectors(state.x), v = to_vectors(state.v);
    add_membrane_damping(*model.elements, x, v, force);
    add_bending_damping(*model.elements, x, v, force);
  }
  if (model.material.damping == 0 && model.material.damping_time == 0) return force;
  for (int s = 0; s < static_cast<int>(model.topology->springs.size()); ++s) {
    const Spring& spring = model.topology->springs[s];
    const Vec3 d = state.x.get(spring.j) - state.x.get(spring.i),
               w = state.v.get(spring.j) - state.v.get(spring.i);
    const double b = model.damping(s);
    const Vec3 pull = model.material.damping_kind == DampingKind::plain ? plain_damping_force(b, w)
                                                                        : projected_damping_force(b, d, w);
    force[spring.i] += pull;
    force[spring.j] -= pull;
  }
  return force;
}

std::vector<Vec3> compute_wind_forces(const ClothModel& model, const ClothState& before,
                                      const ClothState& after, const Wind& wind, double time) {
  std::vector<Vec3> force;
  for (int i = 0; i < model.num_particles(); ++i)
    force.push_back(wind_force(wind, model.topology->area[i], after.v.get(i)));
  if (wind.air.density > 0) add_air_forces(model, before, after, wind, time, force);
  return force;
}

}  // namespace weft::engine
