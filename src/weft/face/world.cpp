#include "weft/world.h"

#include <algorithm>
#include <cmath>

#include "weft/face/convert.h"
#include "weft/face/pins.h"
#include "weft/face/world_impl.h"
#include "weft/world/world_input.h"

namespace weft {
namespace {

using engine::from_engine;
using engine::to_engine;

using engine::who;

}  // namespace

Snapshot::Snapshot() : data_(std::make_unique<Data>()) {}
Snapshot::~Snapshot() = default;
Snapshot::Snapshot(Snapshot&&) noexcept = default;
Snapshot& Snapshot::operator=(Snapshot&&) noexcept = default;
Snapshot::Snapshot(const Snapshot& other) : data_(std::make_unique<Data>(*other.data_)) {}
Snapshot& Snapshot::operator=(const Snapshot& other) {
  data_ = std::make_unique<Data>(*other.data_);
  return *this;
}

World::World() : impl_(std::make_unique<Impl>()) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

World World::clone() const {
  World copy;
  copy.impl_->world = impl_->world.clone();
  copy.impl_->cloths = impl_->cloths;
  copy.impl_->colliders = impl_->colliders;
  copy.impl_->wind_keys = impl_->wind_keys;
  copy.impl_->wind = impl_->wind;
  return copy;
}

ClothId World::Impl::add(ClothDesc desc) {
  Cloth cloth{.desc = std::move(desc)};
  const std::string owner = who("cloth", world.free_name(cloth.desc.name, "cloth"));
  cloth.rest = engine::build_rest_shape(cloth.desc, owner, cloth.notes);
  const engine::ClothSubstance made =
      engine::build_substance(cloth.desc, cloth.rest, owner, cloth.notes.warnings);
  const engine::Pose pose = to_engine(cloth.desc.pose);
  engine::require_valid(pose, owner);
  std::vector<engine::Vec3> positions;
  for (const engine::Vec3& p : cloth.rest.topology->mesh.positions)
    positions.push_back(pose.rotation * p + pose.translation);
  const ClothId id = world.add_cloth({.name = cloth.desc.name,
                                      .topology = cloth.rest.topology,
                                      .material = made.material,
                                      .elements = made.elements,
                                      .positions = std::move(positions),
                                      .velocity = to_engine(cloth.desc.velocity),
                                      .layer = cloth.desc.layer,
                                      .tearing = made.tearing});
  cloth.desc.name = world.name(id);
  cloths.push_back(std::move(cloth));
  return id;
}

ColliderId World::Impl::add(ColliderDesc desc) {
  desc.name = world.free_name(desc.name, "collider");
  Collider collider{.built = engine::build_collider(desc, who("collider", desc.name))};
  const ColliderId id = world.add_collider(collider.built.collider);
  collider.desc = std::move(desc);
  colliders.push_back(std::move(collider));
  return id;
}

ClothId World::add_cloth(const ClothDesc& desc) { return impl_->add(desc); }
ColliderId World::add_collider(const ColliderDesc& desc) { return impl_->add(desc); }

void World::remove(ClothId cloth) {
  const int n = impl_->world.index(cloth);
  impl_->world.remove(cloth);
  impl_->cloths.erase(impl_->cloths.begin() + n);
}

void World::remove(ColliderId collider) {
  const int n = impl_->world.index(collider);
  impl_->world.remove(collider);
  impl_->colliders.erase(impl_->colliders.begin() + n);
}

bool World::contains(ClothId cloth) const { return impl_->world.contains(cloth); }
bool World::contains(ColliderId collider) const { return impl_->world.contains(collider); }
int World::num_cloths() const { return impl_->world.num_cloths(); }
int World::num_colliders() const { return impl_->world.num_colliders(); }
ClothId World::cloth(int n) const { return impl_->world.cloth(n); }
ColliderId World::collider(int n) const { return impl_->world.collider(n); }
std::string World::name(ClothId cloth) const { return impl_->world.name(cloth); }
std::string World::name(ColliderId collider) const { return impl_->world.collider(collider).name; }
const ClothNotes& World::notes(ClothId cloth) const { return impl_->at(cloth).notes; }
const std::vector<std::string>& World::warnings(ColliderId collider) const {
  return impl_->at(collider).built.warnings;
}

std::vector<std::string> World::untangle() { return impl_->world.untangle().left; }

void World::move_collider(ColliderId collider, const Pose& at_end) {
  const Impl::Collider& own = impl_->at(collider);
  impl_->world.move_collider(
      collider, engine::to_displacement(at_end, own.desc, engine::pivot(own.built.collider.shape)));
}

void World::place_collider(ColliderId collider, const Pose& pose) {
  const Impl::Collider& own = impl_->at(collider);
  impl_->world.place_collider(
      collider, engine::to_displacement(pose, own.desc, engine::pivot(own.built.collider.shape)));
}

Pose World::pose(ColliderId collider) const {
  const Impl::Collider& own = impl_->at(collider);
  return engine::from_displacement(impl_->world.pose(collider), own.desc,
                                   engine::pivot(own.built.collider.shape));
}

void World::move_vertices(ColliderId collider, const std::vector<Vec3>& at_end) {
  impl_->world.move_vertices(collider, engine::select_vertices(at_end, impl_->at(collider).built));
}

void World::place_vertices(ColliderId collider, const std::vector<Vec3>& positions) {
  impl_->world.place_vertices(collider, engine::select_vertices(positions, impl_->at(collider).built));
}

void World::set_forces(ClothId cloth, const std::vector<Vec3>& forces) {
  impl_->world.set_forces(cloth, to_engine(forces));
}

void World::set_pressure(ClothId cloth, double pressure, bool sealed) {
  impl_->world.set_pressure(cloth, pressure, sealed);
}

double World::pressure(ClothId cloth) const { return impl_->world.pressure(cloth); }
double World::volume(ClothId cloth) const { return impl_->world.volume(cloth); }

void World::set_positions(ClothId cloth, const std::vector<Vec3>& positions) {
  impl_->world.set_positions(cloth, to_engine(positions));
  engine::hold_soft_pins(impl_->world, cloth);
}

void World::set_velocities(ClothId cloth, const std::vector<Vec3>& velocities) {
  impl_->world.set_velocities(cloth, to_engine(velocities));
}

void World::teleport(ClothId cloth, const Pose& displacement, bool keeps_velocity) {
  impl_->world.teleport(cloth, to_engine(displacement));
  engine::hold_soft_pins(impl_->world, cloth);
  if (!keeps_velocity) set_velocities(cloth, std::vector<Vec3>(impl_->world.state(cloth).x.size()));
}

void World::set_fabric(ClothId cloth, const std::variant<Fabric, Springs>& fabric) {
  Impl::Cloth& own = impl_->at(cloth);
  ClothDesc desc = own.desc;
  desc.fabric = fabric;
  std::vector<std::string> warnings;
  engine::ClothSubstance made = engine::build_substance(desc, own.rest, who("cloth", desc.name), warnings);
  for (const Stiffening& s : own.stiffened)
    engine::multiply_spring_factors(*own.rest.topology, s.particles, s.factor, made.material.spring_factors);
  if (made.tearing) {
    impl_->world.set_material(cloth, made.material, made.tearing);
  } else {
    if (impl_->world.can_tear(cloth))
      throw InputError(who("cloth", desc.name) +
                       "it was added with a strength; give it a large one in place of 0");
    impl_->world.set_material(cloth, made.material, made.elements);
  }
  own.desc = std::move(desc);
}

void World::stiffen(ClothId cloth, const std::vector<int>& particles, double factor) {
  Impl::Cloth& own = impl_->at(cloth);
  for (const int i : particles) {
    if (i < 0 || i >= own.rest.topology->num_particles())
      throw InputError(who("cloth", own.desc.name) + "there is no particle " + std::to_string(i));
  }
  if (!std::isfinite(factor) || factor < 0)
    throw InputError(who("cloth", own.desc.name) + "the factor must be 0 or more");
  if (std::holds_alternative<Fabric>(own.desc.fabric) && own.desc.membrane != Membrane::springs)
    throw InputError(who("cloth", own.desc.name) +
                     "its membrane has no springs to stiffen; add it with springs, or change its fabric");
  engine::ClothMaterial material = impl_->world.model(cloth).material;
  engine::multiply_spring_factors(*own.rest.topology, particles, factor, material.spring_factors);
  impl_->world.set_material(cloth, material);
  own.stiffened.push_back({particles, factor});
}

void World::set_friction(ColliderId collider, double friction, double static_friction) {
  impl_->world.set_collider_friction(collider, friction, static_friction);
  ColliderDesc& desc = impl_->colliders[impl_->world.index(collider)].desc;
  desc.friction = friction;
  desc.static_friction = static_friction;
}

void World::set_friction(BodyId a, BodyId b, double friction, double static_friction) {
  impl_->world.set_friction(a, b, friction, static_friction);
}

void World::set_collision(BodyId a, BodyId b, bool collide) { impl_->world.set_collision(a, b, collide); }
void World::set_gravity(const Vec3& gravity) { impl_->world.set_gravity(to_engine(gravity)); }

void World::set_wind(const Wind& wind) {
  std::vector<engine::WindKey> keys = to_engine(wind.keys);
  for (std::size_t k = 0; k < keys.size(); ++k) {
    if (!std::isfinite(keys[k].time) || !keys[k].velocity.allFinite() ||
        (k > 0 && !(keys[k].time > keys[k - 1].time)))
      throw InputError("the wind's keys must be finite, at increasing times");
  }
  engine::Wind now{
      .velocity = to_engine(wind.velocity), .drag = wind.drag, .air = wind.air, .gusts = wind.gusts};
  if (!keys.empty()) now.velocity = engine::wind_velocity(keys, time());
  impl_->world.set_wind(now);
  impl_->wind_keys = std::move(keys);
  impl_->wind = wind;
}

void World::set_integrator(const IntegratorSettings& settings) { impl_->world.set_integrator(settings); }
void World::set_division(const StepDivision& division) { impl_->world.set_division(division); }

void World::set_contact(const ContactSettings& settings) {
  impl_->world.set_contact(settings.enabled);
  impl_->world.track_contacts(settings.tracks_points);
}

void World::set_jobs(std::shared_ptr<JobSystem> jobs) { impl_->world.set_jobs(std::move(jobs)); }

Vec3 World::gravity() const { return from_engine(impl_->world.gravity()); }
Wind World::wind() const { return impl_->wind; }
IntegratorSettings World::integrator() const { return impl_->world.integrator(); }
StepDivision World::division() const { return impl_->world.division(); }
ContactSettings World::contact() const {
  return {impl_->world.has_contact(), impl_->world.tracks_contacts()};
}
const ClothDesc& World::description(ClothId cloth) const { return impl_->at(cloth).desc; }
const ColliderDesc& World::description(ColliderId collider) const { return impl_->at(collider).desc; }

StepReport World::step(double dt) {
  if (!impl_->wind_keys.empty()) {
    engine::Wind now = impl_->world.wind();
    now.velocity = engine::wind_velocity(impl_->wind_keys, time());
    impl_->world.set_wind(now);
  }
  return impl_->world.step(dt);
}

double World::time() const { return impl_->world.time(); }

Snapshot World::snapshot() const {
  Snapshot snapshot;
  snapshot.data_->world = impl_->world.id();
  snapshot.data_->state = impl_->world.snapshot();
  for (const Impl::Cloth& cloth : impl_->cloths) snapshot.data_->is_soft.push_back(cloth.is_soft);
  return snapshot;
}

void World::restore(const Snapshot& snapshot) {
  if (snapshot.data_->world != impl_->world.id())
    throw InputError("this snapshot is empty or belongs to another world");
  impl_->world.restore(snapshot.data_->state);
  for (std::size_t c = 0; c < impl_->cloths.size(); ++c)
    impl_->cloths[c].is_soft = snapshot.data_->is_soft[c];
}

std::uint64_t World::state_hash() const { return impl_->world.state_hash(); }

}  // namespace weft
