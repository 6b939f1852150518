/// World: cloth data and measurements.

#include <cmath>
#include <cstring>

#include "weft/core/angle.h"
#include "weft/face/convert.h"
#include "weft/face/world_impl.h"
#include "weft/forces/membrane.h"
#include "weft/mesh/vertex_normals.h"
#include "weft/world/cloth_forces.h"
#include "weft/world/energy_audit.h"
#include "weft/world/measures.h"

namespace weft {
namespace {

using engine::from_engine;

/// Copies get(i), three numbers per particle, into the caller's memory.
template <class Number, class Get>
void copy_out(std::size_t count, const Get& get, Number* out, std::size_t stride) {
  if (stride < 3 * sizeof(Number)) throw InputError("a stride must be at least the size of three numbers");
  auto* bytes = reinterpret_cast<unsigned char*>(out);
  for (std::size_t i = 0; i < count; ++i, bytes += stride) {
    const auto v = get(i);
    const Number numbers[3] = {static_cast<Number>(v[0]), static_cast<Number>(v[1]),
                               static_cast<Number>(v[2])};
    std::memcpy(bytes, numbers, sizeof numbers);
  }
}

template <class Number>
void copy_normals_out(const engine::ClothModel& model, const engine::ClothState& state, Number* out,
                      std::size_t stride) {
  std::vector<float> offsets(3 * state.x.size());
  copy_out(
      state.x.size(), [&](std::size_t i) { return state.x.get(i); }, offsets.data(), 3 * sizeof(float));
  const std::vector<float> normals = engine::compute_vertex_normals(model.topology->mesh.triangles, offsets);
  copy_out(
      state.x.size(), [&](std::size_t i) { return &normals[3 * i]; }, out, stride);
}

TriangleStrain measure(const engine::RestTriangle& rest, const engine::TriangleCorners& x) {
  const engine::Vec3 green = engine::membrane_strain(rest, x);
  const double warp = std::sqrt(1 + 2 * green.x()), weft = std::sqrt(1 + 2 * green.y());
  const auto [least, most] = engine::principal_stretches(rest, x);
  return {.warp = warp - 1,
          .weft = weft - 1,
          .shear = std::asin(std::clamp(green.z() / (warp * weft), -1.0, 1.0)),
          .min_stretch = least,
          .max_stretch = most};
}

engine::TriangleCorners corners_of(const Triangle& t, const engine::ClothState& state) {
  return {state.x.get(t[0]), state.x.get(t[1]), state.x.get(t[2])};
}

}  // namespace

int World::num_particles(ClothId cloth) const { return impl_->world.model(cloth).num_particles(); }

const std::vector<Triangle>& World::triangles(ClothId cloth) const {
  return impl_->world.model(cloth).topology->mesh.triangles;
}

std::vector<CornerUv> World::uv(ClothId cloth) const { return from_engine(impl_->at(cloth).rest.uv); }

std::vector<Vec3> World::rest_positions(ClothId cloth) const {
  return from_engine(impl_->world.model(cloth).topology->mesh.positions);
}

std::vector<Vec3> World::positions(ClothId cloth) const {
  const engine::ClothState& state = impl_->world.state(cloth);
  std::vector<Vec3> result;
  for (std::size_t i = 0; i < state.x.size(); ++i) result.push_back(from_engine(state.position(i)));
  return result;
}

std::vector<Vec3> World::velocities(ClothId cloth) const {
  const engine::ClothState& state = impl_->world.state(cloth);
  std::vector<Vec3> result;
  for (std::size_t i = 0; i < state.v.size(); ++i) result.push_back(from_engine(state.v.get(i)));
  return result;
}

std::vector<double> World::masses(ClothId cloth) const { return impl_->world.model(cloth).mass; }

ClothOffsets World::offsets(ClothId cloth) const {
  const engine::ClothState& state = impl_->world.state(cloth);
  return {state.x.share(), state.x.size(), state.x.stride(), from_engine(state.origin)};
}

void World::copy_positions(ClothId cloth, float* out, std::size_t stride) const {
  const engine::ClothState& state = impl_->world.state(cloth);
  copy_out(
      state.x.size(), [&](std::size_t i) { return state.position(i); }, out, stride);
}

void World::copy_positions(ClothId cloth, double* out, std::size_t stride) const {
  const engine::ClothState& state = impl_->world.state(cloth);
  copy_out(
      state.x.size(), [&](std::size_t i) { return state.position(i); }, out, stride);
}

void World::copy_velocities(ClothId cloth, float* out, std::size_t stride) const {
  const engine::ClothState& state = impl_->world.state(cloth);
  copy_out(
      state.v.size(), [&](std::size_t i) { return state.v.get(i); }, out, stride);
}

void World::copy_velocities(ClothId cloth, double* out, std::size_t stride) const {
  const engine::ClothState& state = impl_->world.state(cloth);
  copy_out(
      state.v.size(), [&](std::size_t i) { return state.v.get(i); }, out, stride);
}

void World::copy_normals(ClothId cloth, float* out, std::size_t stride) const {
  copy_normals_out(impl_->world.model(cloth), impl_->world.state(cloth), out, stride);
}

void World::copy_normals(ClothId cloth, double* out, std::size_t stride) const {
  copy_normals_out(impl_->world.model(cloth), impl_->world.state(cloth), out, stride);
}

std::vector<Vec3> World::vertex_positions(ClothId cloth) const {
  const Impl::Cloth& own = impl_->at(cloth);
  const engine::ClothState& state = impl_->world.state(cloth);
  std::vector<Vec3> result;
  for (std::size_t v = 0; v < own.notes.particle_of_vertex.size(); ++v) {
    const int particle = own.notes.particle_of_vertex[v];
    if (particle >= 0) {
      result.push_back(from_engine(state.position(particle)));
    } else {
      const Vec3& rest = std::get<TriangleMesh>(own.desc.shape).positions[v];
      result.push_back(own.desc.pose.rotation * rest + own.desc.pose.translation);
    }
  }
  return result;
}

std::vector<Vec3> World::forces(ClothId cloth, ForceKind kind) const {
  const engine::World& world = impl_->world;
  const engine::ClothModel& model = world.model(cloth);
  const engine::ClothState& state = world.state(cloth);
  std::vector<engine::Vec3> force(state.x.size(), engine::Vec3::Zero());
  switch (kind) {
    case ForceKind::gravity:
      for (std::size_t i = 0; i < force.size(); ++i) force[i] = model.mass[i] * world.gravity();
      break;
    case ForceKind::elastic:
      force = engine::compute_elastic_forces(model, state);
      break;
    case ForceKind::damping:
      force = engine::compute_damping_forces(model, state);
      break;
    case ForceKind::wind:
      force = engine::compute_wind_forces(model, state, state, world.wind(), world.time());
      break;
    case ForceKind::external:
      if (!world.forces(cloth).empty()) force = world.forces(cloth);
      break;
    case ForceKind::contact: {
      const int n = world.index(cloth);
      for (const engine::ContactPoint& contact : world.contact_points()) {
        if (contact.cloth == n) force[contact.particle] += contact.force;
        if (contact.other_cloth == n) force[contact.other_vertex] -= contact.force;
      }
      break;
    }
  }
  return from_engine(force);
}

std::vector<Vec3> World::forces(ClothId cloth) const {
  std::vector<Vec3> sum(static_cast<std::size_t>(num_particles(cloth)));
  for (const ForceKind kind : {ForceKind::gravity, ForceKind::elastic, ForceKind::damping, ForceKind::wind,
                               ForceKind::external, ForceKind::contact}) {
    const std::vector<Vec3> force = forces(cloth, kind);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = sum[i] + force[i];
  }
  return sum;
}

std::vector<Vec3> World::pin_forces(ClothId cloth) const {
  const std::vector<engine::Vec3> held = impl_->world.pin_forces(cloth);
  const std::vector<engine::Attachment>& soft = impl_->world.attachments(cloth);
  const engine::ClothState& state = impl_->world.state(cloth);
  std::vector<Vec3> result;
  std::size_t h = 0, s = 0;
  for (const char is_soft : impl_->at(cloth).is_soft) {
    if (!is_soft) {
      result.push_back(from_engine(held[h++]));
      continue;
    }
    const engine::Attachment& attachment = soft[s++];
    const int i = attachment.particles[0];
    result.push_back(from_engine(engine::Vec3(attachment.stiffness * (attachment.target - state.position(i)) -
                                              attachment.damping * state.v.get(i))));
  }
  return result;
}

std::vector<double> World::spring_strains(ClothId cloth) const {
  const engine::ClothState& state = impl_->world.state(cloth);
  std::vector<double> strains;
  for (const engine::Spring& s : impl_->world.model(cloth).topology->springs)
    strains.push_back((state.x.get(s.j) - state.x.get(s.i)).norm() / s.rest_length - 1);
  return strains;
}

std::vector<TriangleStrain> World::triangle_strains(ClothId cloth) const {
  const engine::ClothModel& model = impl_->world.model(cloth);
  const engine::ClothState& state = impl_->world.state(cloth);
  const engine::RestMesh& mesh = model.topology->mesh;
  const bool has_membranes = model.elements && !model.elements->membranes.empty();
  std::vector<TriangleStrain> strains;
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    const engine::RestTriangle rest =
        has_membranes ? model.elements->membranes[t].rest : engine::make_rest_triangle(mesh, t);
    strains.push_back(measure(rest, corners_of(mesh.triangles[t], state)));
  }
  return strains;
}

std::vector<ContactPoint> World::contact_points() const {
  std::vector<ContactPoint> points;
  for (const engine::ContactPoint& p : impl_->world.contact_points()) {
    ContactPoint& to = points.emplace_back();
    to.position = from_engine(p.position);
    to.normal = from_engine(p.normal);
    to.force = from_engine(p.force);
    to.cloth = cloth(p.cloth);
    to.particle = p.particle;
    if (p.other_cloth >= 0) to.other_cloth = cloth(p.other_cloth);
    if (p.collider >= 0) to.collider = collider(p.collider);
    to.other_vertex = p.other_vertex;
  }
  return points;
}

Energies World::energies() const {
  const engine::WorldEnergy e = engine::compute_energy(impl_->world);
  return {e.kinetic, e.elastic, e.bending, e.gravitational};
}

Vec3 World::momentum(ClothId cloth) const {
  return from_engine(engine::compute_momentum(impl_->world.model(cloth), impl_->world.state(cloth)));
}

Vec3 World::center_of_mass(ClothId cloth) const {
  return from_engine(engine::compute_center_of_mass(impl_->world.model(cloth), impl_->world.state(cloth)));
}

}  // namespace weft
