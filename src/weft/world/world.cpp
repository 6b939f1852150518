#include "weft/world/world.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "weft/animation/mesh_sequence.h"
#include "weft/core/hash.h"
#include "weft/forces/pressure.h"
#include "weft/forces/seam_springs.h"
#include "weft/world/infeasible_pairs.h"
#include "weft/world/measures.h"
#include "weft/world/world_input.h"

namespace weft::engine {
namespace {

/// A sum of products with zero: 0 if all values are finite, else NaN.
float finite_check(const float* values, std::size_t count) {
  constexpr std::size_t kLanes = 16;
  float sums[kLanes] = {};
  for (std::size_t i = 0; i + kLanes <= count; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) sums[lane] += 0.0f * values[i + lane];
  }
  float sum = 0;
  for (const float s : sums) sum += s;
  for (std::size_t i = count - count % kLanes; i < count; ++i) sum += 0.0f * values[i];
  return sum;
}

bool is_finite(const Vec3Array& a) {
  return finite_check(a.x(), a.size()) == 0 && finite_check(a.y(), a.size()) == 0 &&
         finite_check(a.z(), a.size()) == 0;
}

/// Index of the first particle whose position or velocity is not finite, -1 if all are.
int find_non_finite(const ClothState& state) {
  if (is_finite(state.x) && is_finite(state.v)) return -1;
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    if (!state.x.get(i).allFinite() || !state.v.get(i).allFinite()) return static_cast<int>(i);
  }
  return -1;
}

std::uint32_t next_world_id() {
  static std::atomic<std::uint32_t> last{0};
  return ++last;
}

/// Binary search by ascending number; -1 if not found.
template <class Entries>
int find_number(const Entries& entries, std::uint32_t number) {
  const auto found = std::ranges::lower_bound(entries, number, {}, [](const auto& t) { return t.number; });
  return found != entries.end() && found->number == number ? static_cast<int>(found - entries.begin()) : -1;
}

template <class Entries, class Id>
std::size_t index_of_id(const Entries& entries, Id id, std::uint32_t world, std::string_view kind) {
  if (id.number == 0) throw InputError("this " + std::string(kind) + " is empty: it refers to nothing");
  if (id.world != world) throw InputError("this " + std::string(kind) + " belongs to another world");
  const int index = find_number(entries, id.number);
  if (index >= 0) return static_cast<std::size_t>(index);
  throw InputError("this " + std::string(kind) + " (number " + std::to_string(id.number) +
                   ") refers to a removed body");
}

std::shared_ptr<const VertexSource> make_sequence(std::vector<MeshSequence::Key> keys) {
  return std::make_shared<const MeshSequence>(std::move(keys));
}

void require_points(const std::vector<Vec3>& values, std::size_t count, const std::string& what) {
  require(values.size() == count,
          what + ": expected " + std::to_string(count) + ", got " + std::to_string(values.size()));
  require_finite(values, what);
}

constexpr double kForever = std::numeric_limits<double>::infinity();
constexpr int kMaxParts = 1 << 12;  // of one step [1]
constexpr int kCalmParts = 4;       // consecutive ones before parts become longer
constexpr int kTearingParts = 4;    // least number while cloth tears [1]
constexpr double kFarTooLong = 4;   // severity from which a part is divided in four [1]
constexpr double kCalm = 0.5;       // severity of a part that could have been longer [1]

}  // namespace

Vec3 PointGuide::at(std::size_t point, double time) const {
  if (time <= start) return from[point];
  if (time >= end) return to[point];
  return from[point] + (time - start) / (end - start) * (to[point] - from[point]);
}

void PointGuide::begin_step(double time, double dt) {
  if (is_new) {
    start = time;
    end = time + dt;
  } else {
    from = to;
  }
  is_new = false;
}

World::World() : id_(next_world_id()), integrator_(make_integrator({})), jobs_(make_serial_jobs()) {}

ClothId World::cloth(int n) const {
  require(n >= 0 && n < num_cloths(), "cloth index " + std::to_string(n) +
                                          " is out of range; the world has " + std::to_string(num_cloths()));
  return {id_, cloths_[n].number};
}

ColliderId World::collider(int n) const {
  require(n >= 0 && n < num_colliders(), "collider index " + std::to_string(n) +
                                             " is out of range; the world has " +
                                             std::to_string(num_colliders()));
  return {id_, guides_[n].number};
}

bool World::contains(ClothId id) const { return id.world == id_ && find_number(cloths_, id.number) >= 0; }
bool World::contains(ColliderId id) const { return id.world == id_ && find_number(guides_, id.number) >= 0; }

std::size_t World::index_of(ClothId id) const { return index_of_id(cloths_, id, id_, "ClothId"); }
std::size_t World::index_of(ColliderId id) const { return index_of_id(guides_, id, id_, "ColliderId"); }

World::Cloth& World::at(ClothId id) { return cloths_[index_of(id)]; }
const World::Cloth& World::at(ClothId id) const { return cloths_[index_of(id)]; }

bool World::has_name(const std::string& name) const {
  const auto is_its = [&](const auto& thing) { return thing.name == name; };
  return std::ranges::any_of(cloths_, is_its) || std::ranges::any_of(colliders_, is_its);
}

std::string World::free_name(const std::string& wanted, const std::string& kind) const {
  std::string name = wanted.empty() ? kind : wanted;
  for (int n = 2; wanted.empty() && has_name(name); ++n) name = kind + ' ' + std::to_string(n);
  return name;
}

ClothId World::add_cloth(const ClothParts& given) {
  ClothParts desc = given;
  desc.name = free_name(given.name, "cloth");
  require(desc.topology != nullptr, "cloth \"" + desc.name + "\" has no topology");
  require_valid(*desc.topology, desc.name);
  require_valid(desc.material, desc.name);
  const std::vector<Vec3>& positions =
      desc.positions.empty() ? desc.topology->mesh.positions : desc.positions;
  require(static_cast<int>(positions.size()) == desc.topology->num_particles(),
          "cloth \"" + desc.name + "\" has " + std::to_string(desc.topology->num_particles()) +
              " particles but " + std::to_string(positions.size()) + " positions");
  Cloth cloth;
  cloth.name = desc.name;
  if (desc.elements) require_elements_supported(integrator_settings_.integrator, *desc.elements, desc.name);
  require_seams_supported(integrator_settings_.integrator, desc.topology->seams, desc.name);
  cloth.model = build_cloth_model(desc.topology, desc.material, desc.elements);
  cloth.state = make_state(positions);
  for (std::size_t i = 0; i < positions.size(); ++i) cloth.state.v.set(i, desc.velocity);
  require(find_non_finite(cloth.state) < 0,
          "cloth \"" + desc.name + "\" has a non-finite position or velocity");
  cloth.is_pinned.assign(positions.size(), 0);
  cloth.layer = desc.layer;
  cloth.tearing = desc.tearing;
  cloth.number = ++last_number_;
  last_step_ = 0;
  cloths_.push_back(std::move(cloth));
  return {id_, last_number_};
}

ColliderId World::add_collider(Collider collider) {
  collider.name = free_name(collider.name, "collider");
  require_valid(collider);
  colliders_.push_back(std::move(collider));
  guides_.push_back({.number = ++last_number_});
  return {id_, last_number_};
}

void World::remove(ClothId id) {
  const int index = static_cast<int>(index_of(id));
  std::erase_if(rules_, [&](const ContactRule& r) { return r.cloth == index || r.other_cloth == index; });
  for (ContactRule& r : rules_) {
    r.cloth -= r.cloth > index;
    r.other_cloth -= r.other_cloth > index;
  }
  cloths_.erase(cloths_.begin() + index);
  last_step_ = 0;
  contact_system_ = {};
}

void World::remove(ColliderId id) {
  const int index = static_cast<int>(index_of(id));
  std::erase_if(rules_, [&](const ContactRule& r) { return r.collider == index; });
  for (ContactRule& r : rules_) r.collider -= r.collider > index;
  for (Cloth& cloth : cloths_) {
    release_followers(index, cloth);
    cloth.state.caught.clear();
  }
  colliders_.erase(colliders_.begin() + index);
  guides_.erase(guides_.begin() + index);
  contact_system_ = {};
}

/// Pins and attachments that follow a collider, which is being removed, stay where they are.
void World::release_followers(int collider, Cloth& cloth) {
  for (PinnedParticle& p : cloth.pinned) {
    if (cloth.pins[p.pin].follow == collider) p.anchor = cloth.state.position(p.particle);
  }
  for (Pin& pin : cloth.pins) pin.follow = pin.follow == collider ? -1 : pin.follow - (pin.follow > collider);
  std::vector<Attachment> attachments = cloth.attachments.attachments();
  for (Attachment& a : attachments) a.follow = a.follow == collider ? -1 : a.follow - (a.follow > collider);
  cloth.attachments.set(std::move(attachments));
}

Pose World::pose(ColliderId id) const { return colliders_[index_of(id)].motion.at(time_); }

void World::move_collider(ColliderId id, const Pose& at_end) {
  require_valid(at_end, "collider \"" + collider(id).name + "\", moved: ");
  Guide& guide = guides_[index_of(id)];
  guide.moves_by_hand = true;
  guide.pose = at_end;
}

void World::place_collider(ColliderId id, const Pose& pose) {
  const std::size_t index = index_of(id);
  require_valid(pose, "collider \"" + colliders_[index].name + "\", moved: ");
  colliders_[index].motion = RigidMotion(pose);
  guides_[index].moves_by_hand = true;
  guides_[index].pose.reset();
  contact_system_ = {};
}

MeshShape& World::mesh_of(ColliderId id, const std::vector<Vec3>& positions) {
  Collider& collider = colliders_[index_of(id)];
  const std::string who = "collider \"" + collider.name + "\": ";
  MeshShape* shape = std::get_if<MeshShape>(&collider.shape);
  require(shape != nullptr, who + "it is not a mesh and has no vertices");
  require(static_cast<int>(positions.size()) == shape->mesh->num_vertices(),
          who + "expected " + std::to_string(shape->mesh->num_vertices()) + " vertices, got " +
              std::to_string(positions.size()));
  require(std::ranges::all_of(positions, [](const Vec3& p) { return p.allFinite(); }),
          who + "a vertex has a non-finite coordinate");
  return *shape;
}

void World::move_vertices(ColliderId id, std::vector<Vec3> at_end) {
  MeshShape& shape = mesh_of(id, at_end);
  Guide& guide = guides_[index_of(id)];
  if (!guide.deforms_by_hand) shape.source = make_sequence({{time_, shape.at(time_).vertices()}});
  guide.deforms_by_hand = true;
  guide.vertices = std::move(at_end);
}

void World::place_vertices(ColliderId id, std::vector<Vec3> positions) {
  MeshShape& shape = mesh_of(id, positions);
  shape.source = make_sequence({{time_, std::move(positions)}});
  guides_[index_of(id)].deforms_by_hand = true;
  guides_[index_of(id)].vertices.reset();
  contact_system_ = {};
}

void World::set_collider_friction(ColliderId id, double friction, double static_friction) {
  Collider changed = collider(id);
  changed.friction = friction;
  changed.static_friction = static_friction;
  require_valid(changed);
  colliders_[index_of(id)] = std::move(changed);
}

/// Kinematic colliders move to their target in the step that begins, or stand still.
void World::guide_colliders(double dt) {
  const double end = time_ + dt;
  for (std::size_t c = 0; c < colliders_.size(); ++c) {
    Guide& guide = guides_[c];
    if (guide.moves_by_hand) {
      RigidMotion& motion = colliders_[c].motion;
      const Pose now = motion.at(time_);
      motion = guide.pose ? RigidMotion(time_, now, end, *guide.pose) : RigidMotion(now);
      guide.pose.reset();
    }
    if (guide.deforms_by_hand) {
      MeshShape& shape = std::get<MeshShape>(colliders_[c].shape);
      if (!guide.vertices && shape.source->is_still()) continue;
      std::vector<MeshSequence::Key> keys = {{time_, shape.at(time_).vertices()}};
      if (guide.vertices) keys.push_back({end, std::move(*guide.vertices)});
      shape.source = make_sequence(std::move(keys));
      guide.vertices.reset();
    }
  }
}

void World::set_gravity(const Vec3& gravity) {
  require(gravity.allFinite(), "gravity must be finite");
  gravity_ = gravity;
}

void World::set_jobs(std::shared_ptr<JobSystem> jobs) {
  require(jobs != nullptr, "a world requires a job system; make_serial_jobs() makes one without threads");
  jobs_ = std::move(jobs);
}

World World::clone() const {
  World copy;
  copy.id_ = id_;
  copy.last_number_ = last_number_;
  copy.time_ = time_;
  copy.contact_ = contact_;
  copy.tracks_contacts_ = tracks_contacts_;
  copy.gravity_ = gravity_;
  copy.wind_ = wind_;
  copy.set_integrator(integrator_settings_);
  copy.division_ = division_;
  copy.part_ = part_;
  copy.calm_ = calm_;
  copy.jobs_ = jobs_;
  copy.cloths_ = cloths_;
  copy.colliders_ = colliders_;
  copy.guides_ = guides_;
  copy.rules_ = rules_;
  return copy;
}

void World::set_pins(ClothId id, std::vector<Pin> pins) {
  Cloth& cloth = at(id);
  place_pins(cloth, std::move(pins));
  bind_pins(cloth);
}

/// Those that follow a collider are not bound yet.
void World::place_pins(Cloth& cloth, std::vector<Pin> pins) {
  std::vector<char> is_pinned(cloth.state.x.size(), 0);
  std::vector<PinnedParticle> pinned;
  for (int p = 0; p < static_cast<int>(pins.size()); ++p) {
    for (const int i : pins[p].particles) {
      require(i >= 0 && i < cloth.model->num_particles(), "cloth \"" + cloth.name + "\" has no particle " +
                                                              std::to_string(i) + " to pin; it has " +
                                                              std::to_string(cloth.model->num_particles()));
      require(!is_pinned[i],
              "cloth \"" + cloth.name + "\": particle " + std::to_string(i) + " is pinned twice");
      is_pinned[i] = 1;
      pinned.push_back({i, p, cloth.state.position(i), static_cast<int>(pinned.size()), {}});
    }
    require(
        pins[p].follow < 0 || (pins[p].follow < num_colliders() && pins[p].motion.is_still()),
        "cloth \"" + cloth.name + "\": a pin follows a collider of the world, without a motion of its own");
  }
  std::sort(pinned.begin(), pinned.end(),
            [](const auto& a, const auto& b) { return a.particle < b.particle; });
  cloth.pins = std::move(pins);
  cloth.pinned = std::move(pinned);
  cloth.is_pinned = std::move(is_pinned);
  cloth.pin_guide = {};
}

/// Binds the particles of pins that follow a collider to it, where their anchors are.
void World::bind_pins(Cloth& cloth) const {
  for (std::size_t k = 0; k < cloth.pins.size(); ++k) {
    if (cloth.pins[k].follow < 0) continue;
    const PlacedCollider body = place(colliders_[cloth.pins[k].follow], time_);
    for (PinnedParticle& p : cloth.pinned) {
      if (p.pin == static_cast<int>(k)) p.on_surface = bind_point(body, p.anchor);
    }
  }
}

std::vector<SurfaceAnchor> World::bind(int collider, const std::vector<Vec3>& points) const {
  const PlacedCollider body = place(colliders_[collider], time_);
  std::vector<SurfaceAnchor> anchors;
  for (const Vec3& p : points) anchors.push_back(bind_point(body, p));
  return anchors;
}

void World::move_pins(ClothId id, const std::vector<Vec3>& at_end) {
  Cloth& cloth = at(id);
  require_points(at_end, cloth.pinned.size(), "cloth \"" + cloth.name + "\": targets of pins");
  PointGuide guide{.from = at_end, .to = at_end, .is_new = true};
  for (const PinnedParticle& p : cloth.pinned) guide.from[p.order] = cloth.state.position(p.particle);
  cloth.pin_guide = std::move(guide);
}

void World::move_attachments(ClothId id, const std::vector<Vec3>& at_end) {
  Cloth& cloth = at(id);
  require_points(at_end, cloth.attachments.attachments().size(),
                 "cloth \"" + cloth.name + "\": targets of grabs");
  cloth.attachment_guide = {.from = {}, .to = at_end, .is_new = true};
  for (const Attachment& attachment : cloth.attachments.attachments())
    cloth.attachment_guide.from.push_back(attachment.target);
}

void World::set_attachment_target(ClothId id, int attachment, const Vec3& target) {
  Cloth& cloth = at(id);
  if (attachment < 0 || attachment >= cloth.attachments.size())
    throw InputError("cloth \"" + cloth.name + "\" has no grab " + std::to_string(attachment));
  if (!target.allFinite()) throw InputError("a grab's target must be finite");
  cloth.attachments.set_target(attachment, target);
  const int follow = cloth.attachments.attachments()[attachment].follow;
  if (follow >= 0) cloth.attachments.set_anchor(attachment, bind(follow, {target})[0]);
  cloth.attachment_guide = {};
}

void World::set_forces(ClothId id, const std::vector<Vec3>& forces) {
  Cloth& cloth = at(id);
  if (!forces.empty())
    require_points(forces, cloth.state.x.size(), "cloth \"" + cloth.name + "\": external forces");
  cloth.forces = forces;
  set_acceleration(cloth);
}

void World::set_acceleration(Cloth& cloth) {
  cloth.environment.acceleration.clear();
  for (std::size_t i = 0; i < cloth.forces.size(); ++i)
    cloth.environment.acceleration.push_back(cloth.forces[i] / cloth.model->mass[i]);
}

/// Points moved by the program go to their targets in the step that begins, or stay.
void World::guide_points(double dt) {
  for (Cloth& cloth : cloths_) {
    cloth.pin_guide.begin_step(time_, dt);
    cloth.attachment_guide.begin_step(time_, dt);
  }
}

void World::set_attachments(ClothId id, std::vector<Attachment> attachments) {
  Cloth& cloth = at(id);
  for (const Attachment& attachment : attachments) {
    for (const int i : attachment.particles) {
      require(i >= 0 && i < cloth.model->num_particles(),
              "cloth \"" + cloth.name + "\" has no particle " + std::to_string(i) + " to grab");
    }
    require(attachment.shares.size() == attachment.particles.size() &&
                attachment.offsets.size() == attachment.particles.size(),
            "a grab requires one share and one offset per particle");
    require(attachment.follow < num_colliders(), "a grab follows a collider that is not in the world");
    require(std::isfinite(attachment.stiffness) && attachment.stiffness >= 0 &&
                std::isfinite(attachment.damping) && attachment.damping >= 0,
            "a grab's stiffness and damping must be 0 or more");
  }
  cloth.attachments.set(std::move(attachments));
  cloth.attachment_guide = {};
}

void World::set_positions(ClothId id, const std::vector<Vec3>& positions) {
  Cloth& cloth = at(id);
  require_points(positions, cloth.state.x.size(), "cloth \"" + cloth.name + "\": positions");
  ClothState state = make_state(positions);                                   // with an origin near them
  if (state.origin == cloth.state.origin) state.origin = cloth.state.origin;  // with the signs of its zeros
  for (std::size_t i = 0; i < positions.size(); ++i) state.v.set(i, cloth.state.v.get(i));
  cloth.state = state;  // a copy, which keeps the memory that views show
  last_step_ = 0;
  for (PinnedParticle& p : cloth.pinned) {
    const Pin& pin = cloth.pins[p.pin];
    p.anchor = apply_inverse(pin.motion.at(time_), pin.pivot, positions[p.particle]);
    if (!cloth.pin_guide.is_empty())
      cloth.pin_guide.from[p.order] = cloth.pin_guide.to[p.order] = positions[p.particle];
  }
  bind_pins(cloth);
}

void World::set_velocities(ClothId id, const std::vector<Vec3>& velocities) {
  Cloth& cloth = at(id);
  require_points(velocities, cloth.state.x.size(), "cloth \"" + cloth.name + "\": velocities");
  for (std::size_t i = 0; i < velocities.size(); ++i) cloth.state.v.set(i, velocities[i]);
  cloth.state.history.step = 0;
  last_step_ = 0;
}

void World::teleport(ClothId id, const Pose& pose) {
  const Cloth& cloth = at(id);
  require_valid(pose, "cloth \"" + cloth.name + "\", moved: ");
  std::vector<Vec3> positions, velocities;
  for (std::size_t i = 0; i < cloth.state.x.size(); ++i) {
    positions.push_back(apply(pose, Vec3::Zero(), cloth.state.position(i)));
    velocities.push_back(pose.rotation * cloth.state.v.get(i));
  }
  set_positions(id, positions);
  set_velocities(id, velocities);
}

void World::set_material(ClothId id, const ClothMaterial& material) {
  const Cloth& cloth = at(id);
  set_material(id, material, cloth.model->elements);
}

void World::set_material(ClothId id, const ClothMaterial& material,
                         std::shared_ptr<const ClothElements> elements) {
  Cloth& cloth = at(id);
  require_valid(material, cloth.name);
  if (elements) require_elements_supported(integrator_settings_.integrator, *elements, cloth.name);
  const Gas gas = cloth.model->gas;
  cloth.model = build_cloth_model(cloth.model->topology, material, std::move(elements));
  set_gas(cloth, gas);
  set_acceleration(cloth);
}

void World::set_gas(Cloth& cloth, const Gas& gas) {
  if (gas != cloth.model->gas) cloth.model = with_gas(*cloth.model, gas);
}

void World::set_pressure(ClothId id, double pressure, bool is_sealed) {
  Cloth& cloth = at(id);
  require(std::isfinite(pressure), "cloth \"" + cloth.name + "\": its pressure must be finite");
  if (pressure == 0 && !is_sealed) return set_gas(cloth, {});
  require_closed(cloth.model->topology->mesh, cloth.name);
  require_pressure_supported(integrator_settings_.integrator, cloth.name);
  const double volume =
      cloth.model->gas.orientation * compute_volume(*cloth.model, cloth.state);  // the mesh's
  const double orientation = volume < 0 ? -1 : 1;
  if (!is_sealed) return set_gas(cloth, {.pressure = pressure, .orientation = orientation});
  require(volume != 0 && pressure > -kAirPressure,
          "cloth \"" + cloth.name + "\": sealed gas requires a volume, and a pressure above -101325 Pa");
  Gas gas = seal_gas(pressure, std::abs(volume));
  gas.orientation = orientation;
  set_gas(cloth, gas);
}

double World::pressure(ClothId id) const { return excess_of(at(id)); }

double World::excess_of(const Cloth& cloth) {
  const Gas& gas = cloth.model->gas;
  return gas.is_sealed() ? gas_excess(gas, compute_volume(*cloth.model, cloth.state)) : gas.pressure;
}

double World::volume(ClothId id) const {
  const Cloth& cloth = at(id);
  require_closed(cloth.model->topology->mesh, cloth.name);
  return std::abs(compute_volume(*cloth.model, cloth.state));
}

void World::set_wind(const Wind& wind) {
  require_valid(wind, integrator_settings_.integrator);
  wind_ = wind;
}

BodyPlace World::find_place(const std::string& name) const {
  std::vector<BodyPlace> found;
  for (int c = 0; c < num_cloths(); ++c) {
    if (cloths_[c].name == name) found.push_back({c, -1, 0});
  }
  for (int c = 0; c < num_colliders(); ++c) {
    if (colliders_[c].name == name) found.push_back({-1, c, 0});
  }
  require(!found.empty(), "no cloth or collider is named \"" + name + "\"");
  require(found.size() == 1,
          std::to_string(found.size()) + " bodies are named \"" + name + "\"; names must be unique");
  return found[0];
}

BodyPlace World::place_of(const BodyId& id) const {
  if (const ClothId* cloth = std::get_if<ClothId>(&id)) return {static_cast<int>(index_of(*cloth)), -1, 0};
  return {-1, static_cast<int>(index_of(std::get<ColliderId>(id))), 0};
}

ContactRule& World::rule_for(BodyPlace cloth, BodyPlace other) {
  if (cloth.cloth < 0) std::swap(cloth, other);
  require(cloth.cloth >= 0,
          name_of(cloth) + " and " + name_of(other) +
              " are both colliders, which do not collide with each other; one of the two must be a cloth");
  if (other.cloth > cloth.cloth) std::swap(cloth, other);
  const auto is_theirs = [&](const ContactRule& r) {
    return r.cloth == cloth.cloth && r.other_cloth == other.cloth && r.collider == other.collider;
  };
  const auto known = std::find_if(rules_.begin(), rules_.end(), is_theirs);
  if (known != rules_.end()) return *known;
  return rules_.emplace_back(ContactRule{cloth.cloth, other.cloth, other.collider, {}, {}, true});
}

void World::set_friction(const std::string& a, const std::string& b, double friction,
                         double static_friction) {
  set_friction_at(find_place(a), find_place(b), friction, static_friction);
}

void World::set_friction(BodyId a, BodyId b, double friction, double static_friction) {
  set_friction_at(place_of(a), place_of(b), friction, static_friction);
}

void World::set_friction_at(BodyPlace a, BodyPlace b, double friction, double static_friction) {
  for (const double number : {friction, static_friction})
    require(std::isfinite(number) && number >= 0,
            "the friction of " + name_of(a) + " and " + name_of(b) + " must be 0 or more");
  ContactRule& rule = rule_for(a, b);
  rule.friction = friction;
  rule.static_friction = static_friction;
}

void World::set_collision(const std::string& a, const std::string& b, bool collide) {
  rule_for(find_place(a), find_place(b)).collide = collide;
}

void World::set_collision(BodyId a, BodyId b, bool collide) {
  rule_for(place_of(a), place_of(b)).collide = collide;
}

std::vector<std::array<std::string, 2>> World::non_colliding_pairs() const {
  std::vector<std::array<std::string, 2>> pairs;
  for (const ContactRule& r : rules_) {
    if (r.collide) continue;
    pairs.push_back({cloths_[r.cloth].name,
                     r.other_cloth >= 0 ? cloths_[r.other_cloth].name : colliders_[r.collider].name});
  }
  return pairs;
}

void World::set_integrator(const IntegratorSettings& settings) {
  std::unique_ptr<Integrator> integrator = make_integrator(settings);  // throws before anything has changed
  require_valid(settings);
  for (const Cloth& cloth : cloths_) {
    if (cloth.model->elements)
      require_elements_supported(settings.integrator, *cloth.model->elements, cloth.name);
    if (cloth.model->gas.is_active()) require_pressure_supported(settings.integrator, cloth.name);
    require_seams_supported(settings.integrator, cloth.model->topology->seams, cloth.name);
  }
  require_valid(wind_, settings.integrator);
  integrator_settings_ = settings;
  integrator_ = std::move(integrator);
  for (Cloth& cloth : cloths_) cloth.state.history.step = 0;
}

/// Places the colliders that pins or attachments follow.
void World::place_followed(double time) {
  followed_.assign(colliders_.size(), std::nullopt);
  const auto add = [&](int collider) {
    if (collider >= 0 && !followed_[collider]) followed_[collider] = place(colliders_[collider], time);
  };
  for (const Cloth& cloth : cloths_) {
    for (const Pin& pin : cloth.pins) add(pin.follow);
    for (const Attachment& attachment : cloth.attachments.attachments()) add(attachment.follow);
  }
}

void World::set_environment(Cloth& cloth, double time) {
  Environment& environment = cloth.environment;
  environment.gravity = gravity_;
  environment.time = time;
  environment.wind = wind_;
  environment.pins.particle.clear();
  environment.pins.position.clear();
  poses_.clear();
  for (const Pin& pin : cloth.pins) poses_.push_back(pin.motion.at(time));
  for (const PinnedParticle& p : cloth.pinned) {
    const Pin& pin = cloth.pins[p.pin];
    environment.pins.particle.push_back(p.particle);
    environment.pins.position.push_back(!cloth.pin_guide.is_empty() ? cloth.pin_guide.at(p.order, time)
                                        : pin.follow >= 0 ? position_of(p.on_surface, *followed_[pin.follow])
                                                          : apply(poses_[p.pin], pin.pivot, p.anchor));
  }
}

/// The maximum over the cloths: they meet at the end of every substep.
int World::num_substeps(double dt) const {
  int substeps = 1;
  const Environment environment{.gravity = gravity_, .wind = wind_};
  for (const Cloth& cloth : cloths_)
    substeps = std::max(substeps, integrator_->num_substeps(*cloth.model, environment, dt));
  return substeps;
}

void World::show_contact_cloths() {
  contact_cloths_.clear();
  for (Cloth& cloth : cloths_)
    contact_cloths_.push_back(
        {cloth.model.get(), &cloth.state, &cloth.is_pinned, std::abs(excess_of(cloth)), cloth.layer});
}

void World::begin_contact(double time, double dt) {
  show_contact_cloths();
  contact_system_.begin_step(
      contact_cloths_, colliders_,
      {.time = time, .step = dt, .tracks = tracks_contacts_, .rules = rules_, .clock = &clock_}, *jobs_);
  if (!integrator_->resolves_contacts()) return;
  pin_positions_.clear();
  for (const Cloth& cloth : cloths_) {
    const std::vector<Vec3>& pins = cloth.environment.pins.position;
    pin_positions_.insert(pin_positions_.end(), pins.begin(), pins.end());
  }
  contact_system_.predict(gravity_, pin_positions_, *jobs_);
  contact_system_.find_contacts(contacts_);
}

/// Advances all cloths by one substep, to `time`.
void World::advance(double time, double dt, StepReport& report) {
  // Kinematics.
  place_followed(time);
  for (Cloth& cloth : cloths_) set_environment(cloth, time);
  // Attachments.
  for (Cloth& cloth : cloths_) {
    for (int g = 0; g < cloth.attachments.size(); ++g) {
      const Attachment& attachment = cloth.attachments.attachments()[g];
      if (attachment.follow >= 0)
        cloth.attachments.set_target(g, position_of(attachment.anchor, *followed_[attachment.follow]));
    }
    for (std::size_t g = 0; g < cloth.attachment_guide.to.size(); ++g)
      cloth.attachments.set_target(static_cast<int>(g), cloth.attachment_guide.at(g, time));
    cloth.held_model = &cloth.attachments.begin(cloth.model, cloth.is_pinned, gravity_, dt, cloth.state);
    cloth.state.history.is_held = !cloth.attachments.are_empty();
  }
  // Contact candidates.
  contacts_.clear();
  if (contact_) begin_contact(time, dt);
  // The solve; once more if contacts were missing from it.
  const bool may_repeat = contact_ && contact_system_.may_meet();
  if (may_repeat) save_states(solve_starts_);
  solve(dt, report);
  if (may_repeat && contact_system_.add_missed_contacts(contacts_, *jobs_)) {
    restore_states(solve_starts_);
    solve(dt, report);
  }
  for (Cloth& cloth : cloths_)
    cloth.attachment_impulse += cloth.attachments.impulse(cloth.is_pinned, dt, cloth.state);
  if (!contact_) return;
  // Contact projection.
  contact_system_.project_contacts(*jobs_);
  // Continuous collision detection: the fail-safe.
  run_ccd_fail_safe(report);
  const int diverged = contact_system_.diverged_cloth();
  if (diverged >= 0) is_diverged_[diverged] = 1;
}

/// Solves all cloths together, and finds the remaining violations of contact.
void World::solve(double dt, StepReport& report) {
  bodies_.clear();
  for (Cloth& cloth : cloths_) bodies_.push_back({cloth.held_model, &cloth.environment, &cloth.state});
  const SystemStep step{.step = dt, .computes_contact_forces = tracks_contacts_, .clock = &clock_};
  const IntegratorReport done = integrator_->advance(bodies_, contacts_, step, *jobs_);
  report.iterations += done.iterations;
  add_count(done.linear_iterations, report.linear_iterations);
  take_larger(done.residual, report.residual);
  add_count(done.guard_events, report.guard_events);
  if (!done.converged) report.warnings.push_back({WarningCode::not_converged, done.unconverged});
  if (!contact_) return;
  contact_system_.read_solution(contacts_);
  contact_system_.find_violations(*jobs_);
}

void World::run_ccd_fail_safe(StepReport& report) {
  const CcdFailSafeReport stopped = contact_system_.run_ccd_fail_safe(*jobs_);
  report.hits += stopped.hits;
  report.zones += stopped.zones;
  for (const Infeasible& pair : stopped.infeasible) {
    const InfeasiblePair described = describe(pair, InfeasibleKind::passed);
    if (!is_attached(described)) add_once(described, report.infeasible);
  }
}

/// Whether the particle is pinned to the collider that it meets: no contact can change that.
bool World::is_attached(const InfeasiblePair& pair) const {
  if (pair.cloth < 0 || pair.collider < 0) return false;
  const Cloth& cloth = cloths_[pair.cloth];
  return std::ranges::any_of(cloth.pinned, [&](const PinnedParticle& p) {
    return p.particle == pair.particle && cloth.pins[p.pin].follow == pair.collider;
  });
}

std::string World::name_of(const BodyPlace& place) const {
  if (place.cloth < 0) return "collider \"" + colliders_[place.collider].name + '"';
  return "cloth \"" + cloths_[place.cloth].name + '"';
}

InfeasiblePair World::describe(const Infeasible& pair, InfeasibleKind kind) const {
  BodyPlace a = contact_system_.place_of(pair.vertex), b{.collider = pair.shape};
  if (pair.shape < 0) b = contact_system_.place_of(pair.other);
  if (a.cloth < 0) std::swap(a, b);
  return {.cloth = a.cloth,
          .particle = a.cloth < 0 ? -1 : a.index,
          .other_cloth = b.cloth,
          .other_particle = b.cloth < 0 ? -1 : b.index,
          .collider = b.collider,
          .kind = kind};
}

/// One sentence for every two bodies that intersect.
std::vector<std::string> World::describe(const Intersections& intersections) const {
  std::vector<std::pair<std::string, int>> counts;  // sentence, count; in the order of first occurrence
  const auto add = [&](const std::string& what, const auto& first) {
    const auto known = std::find_if(counts.begin(), counts.end(), [&](const auto& c) {
      return c.first.compare(0, what.size(), what) == 0;
    });
    if (known != counts.end()) return void(++known->second);
    counts.emplace_back(what + first(), 1);
  };
  for (const EdgeFaceIntersection& p : intersections.edge_face) {
    const auto [i, j] = contact_system_.surface().edges[p.edge];
    const BodyPlace edge = contact_system_.place_of(i), other = contact_system_.place_of(j),
                    triangle = contact_system_.place_of_triangle(p.triangle);
    add("edges of " + name_of(edge) + " intersect triangles of " + name_of(triangle), [&] {
      return ", first edge " + std::to_string(edge.index) + "-" + std::to_string(other.index) +
             " with triangle " + std::to_string(triangle.index);
    });
  }
  for (const Inside& inside : intersections.inside) {
    const BodyPlace place = contact_system_.place_of(inside.vertex);
    add("particles of " + name_of(place) + " are inside " + name_of({-1, inside.collider, 0}),
        [&] { return ", first particle " + std::to_string(place.index); });
  }
  for (const InsideTriangle& inside : intersections.inside_triangles) {
    const BodyPlace place = contact_system_.place_of_triangle(inside.triangle);
    add("triangles of " + name_of(place) + " are in " + name_of({-1, inside.collider, 0}),
        [&] { return ", first triangle " + std::to_string(place.index); });
  }
  for (const Beneath& beneath : intersections.beneath) {
    const BodyPlace place = contact_system_.place_of(beneath.vertex);
    add("particles of " + name_of(place) + " are under " +
            name_of(contact_system_.place_of_triangle(beneath.triangle)) + ", a lower layer",
        [&] { return ", first particle " + std::to_string(place.index); });
  }
  std::vector<std::string> messages;
  for (const auto& [what, count] : counts) messages.push_back(std::to_string(count) + ' ' + what);
  return messages;
}

std::vector<ContactPoint> World::contact_points() const {
  if (!contact_ || !tracks_contacts_) return {};
  return contact_system_.contact_points();
}

void World::set_contact(bool enabled) {
  contact_ = enabled;
  if (enabled) return;
  for (Cloth& cloth : cloths_) cloth.state.history.pressed = {};  // contact begins anew when it is on again
}

void World::set_division(const StepDivision& division) {
  require(std::isfinite(division.shortest) && division.shortest > 0,
          "the shortest part of a step must be more than 0 s");
  const std::string& integrator = integrator_settings_.integrator;
  require(!division.enabled.value_or(false) || find_integrator(integrator).supports.step_division,
          integrator + " does not support step division; use " + list_supporting(&Support::step_division));
  division_ = division;
}

bool World::divides() const {
  const auto has_gas = [](const Cloth& cloth) { return cloth.model->gas.is_active(); };
  if (integrator_settings_.is_double || (!contact_ && std::none_of(cloths_.begin(), cloths_.end(), has_gas)))
    return false;
  const IntegratorRow& integrator = find_integrator(integrator_settings_.integrator);
  return integrator.supports.step_division && division_.enabled.value_or(integrator.divides_steps);
}

bool World::is_driven() const {
  const auto moves = [](const auto& thing) { return !thing.motion.is_still(); };
  if (wind_.drag > 0 || wind_.air.density > 0) return true;
  const auto is_deforming = [](const Collider& c) {
    const auto* mesh = std::get_if<MeshShape>(&c.shape);
    return mesh && mesh->source && !mesh->source->is_still();
  };
  return std::any_of(colliders_.begin(), colliders_.end(), moves) ||
         std::any_of(colliders_.begin(), colliders_.end(), is_deforming) ||
         std::any_of(cloths_.begin(), cloths_.end(), [&](const Cloth& cloth) {
           return !cloth.attachments.are_empty() || !cloth.forces.empty() ||
                  are_seams_closing(*cloth.model, cloth.state) ||
                  cloth.pin_guide.from != cloth.pin_guide.to ||
                  std::any_of(cloth.pins.begin(), cloth.pins.end(), moves);
         });
}

/// The maximum number of parts, a power of two.
int World::num_parts_at_most(double dt) const {
  if (!divides()) return 1;
  constexpr double kRounding = 1e-9;
  int parts = 1;
  while (parts < kMaxParts && dt / (2 * parts) >= division_.shortest * (1 - kRounding)) parts *= 2;
  return parts;
}

/// Advances all cloths from `before` to `time` in a step of dt, and checks the result.
StepCheck World::try_part(const Snapshot& before, double time, double dt, StepReport& report) {
  is_diverged_.assign(cloths_.size(), 0);
  advance(time, dt, report);
  const StepCheck check = check_part(before, dt, report);
  if (!contact_) return check;
  for (const Infeasible& pair : contact_system_.newly_caught())
    add_once(describe(pair, InfeasibleKind::caught), report.infeasible);
  return check;
}

/// Pairs that are infeasible so far request shorter parts; newly caught and pinned particles do not.
StepCheck World::check_part(const Snapshot& before, double dt, StepReport& report) {
  for (int c = 0; c < num_cloths(); ++c) {
    const int broken = find_non_finite(cloths_[c].state);
    if (broken >= 0) return {StepFault::non_finite, kForever, 0, c, broken};
  }
  for (int c = 0; c < num_cloths(); ++c) {
    if (is_diverged_[c]) report.warnings.push_back({WarningCode::contact_skipped, c});
  }
  if (!divides()) return {};
  checked_.clear();
  for (int c = 0; c < num_cloths(); ++c)
    checked_.push_back({*cloths_[c].model, before.states[c], cloths_[c].state});
  StepCheck check = check_step(checked_, gravity_, dt, is_driven());
  for (int c = 0; c < num_cloths(); ++c) {
    if (is_diverged_[c]) check.include({StepFault::skipped, 1, 0, c, -1});
  }
  const auto worst = std::ranges::find_if(report.infeasible, [&](const InfeasiblePair& pair) {
    return pair.cloth < 0 || !cloths_[pair.cloth].is_pinned[pair.particle];
  });
  if (worst != report.infeasible.end())
    check.include({StepFault::infeasible, 1, 0, worst->cloth, worst->particle});
  return check;
}

void World::accept(const StepReport& part, StepReport& report) {
  report.substeps = std::max(report.substeps, part.substeps);
  report.iterations += part.iterations;
  add_count(part.linear_iterations, report.linear_iterations);
  take_larger(part.residual, report.residual);
  add_count(part.guard_events, report.guard_events);
  report.hits += part.hits;
  report.zones += part.zones;
  for (const StepWarning& warning : part.warnings) {
    const auto is_same = [&](const StepWarning& w) {
      return w.code == warning.code && w.cloth == warning.cloth && w.fault == warning.fault;
    };
    const auto known = std::find_if(report.warnings.begin(), report.warnings.end(), is_same);
    if (known == report.warnings.end())
      report.warnings.push_back(warning);
    else if (warning.value > known->value)
      *known = warning;
  }
  for (const InfeasiblePair& pair : part.infeasible) add_once(pair, report.infeasible);
}

/// Rolls the failed step back.
StepReport World::fail(const StepCheck& check, StepReport report) {
  report.ok = false;
  report.torn = 0;
  last_step_ = 0;
  report.warnings.push_back({WarningCode::non_finite, check.cloth, check.particle});
  time_ = before_step_.time;
  part_ = before_step_.part;
  calm_ = before_step_.calm;
  restore_states(before_step_.states);
  for (std::size_t c = 0; c < before_step_.held.size(); ++c)
    hold(cloth(static_cast<int>(c)), before_step_.held[c]);
  report.work = clock_.stop();
  return report;
}

StepReport World::step(double dt) {
  if (!std::isfinite(dt) || dt <= 0)
    throw InputError("the time step must be a finite number of seconds above 0");
  StepReport report;
  clock_.start();
  save(before_step_);
  guide_colliders(dt);
  guide_points(dt);
  before_step_.held.clear();
  if (can_tear()) save_held(before_step_);
  for (Cloth& cloth : cloths_) cloth.attachment_impulse.setZero();
  const int most = num_parts_at_most(dt);  // shortest parts of the step
  int parts = 1;                           // number of parts at the present length
  while (most > 1 && part_ > 0 && parts < most && dt / parts > 1.5 * part_) parts *= 2;
  report.divisions = 0;
  StepCheck worst;
  const double start = time_;
  for (int done = 0; done < most;) {
    const int size = most / parts;
    const double began = clock_.seconds();
    StepReport part;
    if (done > 0) save(before_part_);
    const Snapshot& before = done > 0 ? before_part_ : before_step_;
    attachment_impulses_.clear();
    for (const Cloth& cloth : cloths_) attachment_impulses_.push_back(cloth.attachment_impulse);
    part.substeps = num_substeps(dt * size / most);
    StepCheck check;
    bool stands = true;
    for (int s = 1; s <= part.substeps && stands; ++s) {
      const double length = dt * size / most, end = start + dt * done / most + length * s / part.substeps;
      check = try_part(before, end, length / part.substeps, part);
      stands = check.severity < 1 || (parts == most && check.fault != StepFault::non_finite);
      if (stands && observer_) clock_.leave_out([&] { observer_(end); });
    }
    if (!stands && parts == most) return fail(check, std::move(report));
    if (!stands) {
      restore_states(before.states);
      for (std::size_t c = 0; c < cloths_.size(); ++c)
        cloths_[c].attachment_impulse = attachment_impulses_[c];
      parts = std::min(most, check.severity > kFarTooLong ? 4 * parts : 2 * parts);
      calm_ = 0;
      ++report.retries;
      worst.include(check);
      clock_.times.retries += clock_.seconds() - began;
      continue;
    }
    if (check.severity >= 1 && most > 1)
      part.warnings.push_back(
          {WarningCode::cap_reached, check.cloth, check.particle, check.value, check.fault});
    accept(part, report);
    ++report.divisions;
    done += size;
    calm_ = check.severity < kCalm ? std::min(calm_ + 1, kCalmParts) : 0;
    if (parts > 1 && calm_ >= kCalmParts && done % (2 * size) == 0) {
      parts /= 2;
      calm_ = 0;
    }
    for (Cloth& cloth : cloths_) follow_cloth(cloth.state);
    const int torn = tear();
    if (torn == 0) continue;
    report.torn += torn;
    parts = std::min(most, std::max(parts, kTearingParts));
    calm_ = 0;
    if (observer_) clock_.leave_out([&] { observer_(start + dt * done / most); });
  }
  if (report.retries > 0) report.fault = worst.fault;
  part_ = parts > 1 ? dt / parts : 0;
  time_ = start + dt;
  last_step_ = dt;
  report.work = clock_.stop();
  return report;
}

void World::save(Snapshot& snapshot) const {
  snapshot.time = time_;
  snapshot.part = part_;
  snapshot.calm = calm_;
  save_states(snapshot.states);
}

void World::save_states(std::vector<ClothState>& states) const {
  states.resize(cloths_.size());
  for (std::size_t c = 0; c < cloths_.size(); ++c) states[c] = cloths_[c].state;
}

World::Snapshot World::snapshot() const {
  Snapshot snapshot;
  save(snapshot);
  save_held(snapshot);
  snapshot.guides = guides_;
  for (std::size_t c = 0; c < colliders_.size(); ++c) {
    snapshot.guides[c].motion = colliders_[c].motion;
    if (const MeshShape* shape = std::get_if<MeshShape>(&colliders_[c].shape))
      snapshot.guides[c].source = shape->source;
  }
  return snapshot;
}

void World::save_held(Snapshot& snapshot) const {
  snapshot.held.clear();
  for (int c = 0; c < num_cloths(); ++c) snapshot.held.push_back(held(cloth(c)));
}

World::Held World::held(ClothId id) const {
  const Cloth& cloth = at(id);
  Held held{.pins = cloth.pins,
            .anchors = std::vector<Vec3>(cloth.pinned.size()),
            .on_surface = std::vector<SurfaceAnchor>(cloth.pinned.size()),
            .attachments = cloth.attachments.attachments(),
            .pin_guide = cloth.pin_guide,
            .attachment_guide = cloth.attachment_guide,
            .forces = cloth.forces,
            .gas = cloth.model->gas};
  for (const PinnedParticle& p : cloth.pinned) {
    held.anchors[p.order] = p.anchor;
    held.on_surface[p.order] = p.on_surface;
  }
  return held;
}

void World::hold(ClothId id, Held held) {
  Cloth& cloth = at(id);
  place_pins(cloth, std::move(held.pins));
  for (PinnedParticle& p : cloth.pinned) {
    p.anchor = held.anchors[p.order];
    p.on_surface = held.on_surface[p.order];
  }
  set_attachments(id, std::move(held.attachments));
  cloth.pin_guide = std::move(held.pin_guide);
  cloth.attachment_guide = std::move(held.attachment_guide);
  set_forces(id, held.forces);
  set_gas(cloth, held.gas);
}

void World::restore(const Snapshot& snapshot) {
  require(snapshot.states.size() == cloths_.size(),
          "the snapshot and the world have different numbers of cloths");
  std::vector<std::shared_ptr<const ClothModel>> models;
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    models.push_back(model_for(cloths_[c], snapshot.states[c].torn));
    require(std::cmp_equal(snapshot.states[c].x.size(), models.back()->num_particles()),
            "the snapshot's cloth \"" + cloths_[c].name + "\" has a different number of particles");
  }
  require(snapshot.guides.size() == guides_.size(),
          "the snapshot and the world have different numbers of colliders");
  time_ = snapshot.time;
  part_ = snapshot.part;
  calm_ = snapshot.calm;
  last_step_ = 0;
  for (std::size_t c = 0; c < cloths_.size(); ++c)
    put_back(snapshot.states[c], std::move(models[c]), cloths_[c]);
  for (std::size_t c = 0; c < snapshot.held.size(); ++c) hold(cloth(static_cast<int>(c)), snapshot.held[c]);
  const auto is_by_hand = [](const Guide& g) { return g.moves_by_hand || g.deforms_by_hand; };
  if (std::ranges::any_of(guides_, is_by_hand) || std::ranges::any_of(snapshot.guides, is_by_hand))
    contact_system_ = {};
  for (std::size_t c = 0; c < colliders_.size(); ++c) {
    const std::uint32_t number = guides_[c].number;
    guides_[c] = snapshot.guides[c];
    guides_[c].number = number;
    colliders_[c].motion = guides_[c].motion;
    if (MeshShape* shape = std::get_if<MeshShape>(&colliders_[c].shape)) shape->source = guides_[c].source;
  }
}

void World::restore_states(const std::vector<ClothState>& states) {
  for (std::size_t c = 0; c < cloths_.size(); ++c)
    put_back(states[c], model_for(cloths_[c], states[c].torn), cloths_[c]);
}

/// Contacts refer to particles: those of cloth that has other tears are forgotten.
void World::put_back(const ClothState& state, std::shared_ptr<const ClothModel> model, Cloth& cloth) {
  if (state.torn != cloth.state.torn) contact_system_ = {};
  cloth.model = std::move(model);
  cloth.state = state;
}

std::uint64_t World::state_hash() const {
  Hash hash;
  hash.add(time_);
  for (const Cloth& cloth : cloths_) add_to_hash(cloth.state, hash);
  return hash.value();
}

}  // namespace weft::engine
