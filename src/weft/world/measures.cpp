#include "weft/world/measures.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "weft/forces/gravity.h"
#include "weft/forces/membrane.h"
#include "weft/forces/terms.h"
#include "weft/mesh/solid.h"

namespace weft::engine {

double compute_kinetic_energy(const ClothModel& model, const ClothState& state) {
  double energy = 0;
  for (int i = 0; i < model.num_particles(); ++i)
    energy += 0.5 * model.mass[i] * state.v.get(i).squaredNorm();
  return energy;
}

double compute_volume(const ClothModel& model, const ClothState& state) {
  return model.gas.orientation *
         compute_signed_volume(model.topology->mesh.triangles, [&](int v) { return state.x.get(v); });
}

double compute_elastic_energy(const ClothModel& model, const ClothState& state) {
  const ElasticParts parts = compute_elastic_parts(model, state);
  return parts.stretch + parts.bending;
}

ElasticParts compute_elastic_parts(const ClothModel& model, const ClothState& state) {
  const std::vector<Vec3> x = to_doubles(state.x);
  ElasticParts parts;
  for (const ElasticRow& row : elastic_rows()) {
    if (const auto term = row.make(model, state))
      (row.part == ElasticPart::bending ? parts.bending : parts.stretch) += term->energy(x);
  }
  return parts;
}

double compute_gravity_energy(const ClothModel& model, const ClothState& state, const Vec3& gravity) {
  double energy = 0;
  for (int i = 0; i < model.num_particles(); ++i)
    energy += gravity_energy(model.mass[i], gravity, state.position(i));
  return energy;
}

Vec3 compute_momentum(const ClothModel& model, const ClothState& state) {
  Vec3 momentum = Vec3::Zero();
  for (int i = 0; i < model.num_particles(); ++i) momentum += model.mass[i] * state.v.get(i);
  return momentum;
}

Vec3 compute_angular_momentum(const ClothModel& model, const ClothState& state, const Vec3& point) {
  Vec3 momentum = Vec3::Zero();
  for (int i = 0; i < model.num_particles(); ++i) {
    momentum += model.mass[i] * (state.position(i) - point).cross(state.v.get(i));
  }
  return momentum;
}

Vec3 compute_center_of_mass(const ClothModel& model, const ClothState& state) {
  Vec3 sum = Vec3::Zero();
  double mass = 0;
  for (int i = 0; i < model.num_particles(); ++i) {
    sum += model.mass[i] * state.x.get(i);
    mass += model.mass[i];
  }
  return state.origin + sum / mass;
}

namespace {

double smallest_height(const RestTriangle& rest) {
  double most = 0;
  for (const Vec2& gradient : rest.gradient) most = std::max(most, gradient.squaredNorm());
  return 1 / std::sqrt(most);
}

}  // namespace

double measurable_length(const ClothModel& model) { return 0.1 * model.material.thickness; }

Strain compute_strain(const ClothModel& model, const ClothState& state) {
  Strain strain{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), 0};
  const double shortest = measurable_length(model);
  int count = 0;
  for (const Spring& s : model.topology->springs) {
    if (s.kind != SpringKind::structural || s.rest_length < shortest) continue;
    const double value = (state.x.get(s.j) - state.x.get(s.i)).norm() / s.rest_length - 1;
    strain.min = std::min(strain.min, value);
    strain.max = std::max(strain.max, value);
    strain.mean += value;
    ++count;
  }
  if (count == 0) return {};
  strain.mean /= count;
  return strain;
}

std::optional<Stretches> compute_principal_stretches(const ClothModel& model, const ClothState& state) {
  if (!model.elements || model.elements->membranes.empty()) return {};
  const double shortest = measurable_length(model);
  Stretches all{std::numeric_limits<double>::infinity(), 0};
  for (const auto& [v, rest] : model.elements->membranes) {
    if (smallest_height(rest) < shortest) continue;
    const auto [least, most] =
        principal_stretches(rest, {state.x.get(v[0]), state.x.get(v[1]), state.x.get(v[2])});
    all = {std::min(all.min, least), std::max(all.max, most)};
  }
  return all.max > 0 ? all : Stretches{1, 1};
}

namespace {

/// Stretches of warp and weft in a triangle.
std::array<double, 2> yarn_stretches(const RestTriangle& rest, const TriangleCorners& corners) {
  const Vec3 green = membrane_strain(rest, corners);
  return {std::sqrt(1 + 2 * green.x()), std::sqrt(1 + 2 * green.y())};
}

}  // namespace

YarnStrain compute_yarn_strain(const ClothModel& model, const ClothState& state) {
  const RestMesh& mesh = model.topology->mesh;
  const bool is_at_rest = mesh.at_rest.empty();
  const double shortest = measurable_length(model);
  YarnStrain worst;
  const auto include = [&](double strain, int particle) {
    if (strain > worst.max) worst = {strain, particle};
  };
  if (model.elements && !model.elements->membranes.empty()) {
    for (const auto& [v, rest] : model.elements->membranes) {
      if (smallest_height(rest) < shortest) continue;
      const auto now = yarn_stretches(rest, {state.x.get(v[0]), state.x.get(v[1]), state.x.get(v[2])});
      std::array<double, 2> given = {1, 1};
      if (!is_at_rest)
        given = yarn_stretches(rest, {mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]]});
      for (int k = 0; k < 2; ++k) include(now[k] / std::max(1.0, given[k]) - 1, v[0]);
    }
    return worst;
  }
  for (const Spring& s : model.topology->springs) {
    if (s.kind != SpringKind::structural || s.rest_length < shortest) continue;
    const double given = is_at_rest ? 0 : (mesh.positions[s.j] - mesh.positions[s.i]).norm();
    include((state.x.get(s.j) - state.x.get(s.i)).norm() / std::max(s.rest_length, given) - 1, s.i);
  }
  return worst;
}

AreaShare compute_least_area(const ClothModel& model, const ClothState& state) {
  AreaShare least{std::numeric_limits<double>::infinity(), -1};
  const RestMesh& mesh = model.topology->mesh;
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    const auto& [i, j, k] = mesh.triangles[t];
    const TriangleCorners rest = mesh.corners(t);
    const Vec3 x = state.x.get(i);
    const double area = (state.x.get(j) - x).cross(state.x.get(k) - x).norm(),
                 area_at_rest = (rest[1] - rest[0]).cross(rest[2] - rest[0]).norm();
    if (area < least.min * area_at_rest) least = {area / area_at_rest, i};
  }
  return least;
}

double compute_lowest_y(const ClothState& state) {
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < state.x.size(); ++i) lowest = std::min(lowest, state.position(i).y());
  return lowest;
}

}  // namespace weft::engine
