/// World::save and World::load: a world's descriptions and state as bytes.

#include <algorithm>
#include <utility>

#include "weft/animation/mesh_sequence.h"
#include "weft/core/archive.h"
#include "weft/core/hash.h"
#include "weft/face/convert.h"
#include "weft/face/vertex_motion.h"
#include "weft/face/world_impl.h"

namespace weft {

// Members of each type, in order. Any change of a list is a new version of the format.

namespace engine {

template <class Archive>
void describe(Archive& archive, Vec3& v) {
  for (int c = 0; c < 3; ++c) archive.plain(v[c]);
}
template <class Archive>
void describe(Archive& archive, Mat3& m) {
  for (int e = 0; e < 9; ++e) archive.plain(m(e / 3, e % 3));
}
template <class Archive>
void describe(Archive& archive, weft::Vec3& v) {
  members(archive, v.x, v.y, v.z);
}
template <class Archive>
void describe(Archive& archive, weft::Mat3& m) {
  members(archive, m.row0, m.row1, m.row2);
}
template <class Archive>
void describe(Archive& archive, weft::Pose& p) {
  members(archive, p.translation, p.rotation);
}
template <class Archive>
void describe(Archive& archive, Pose& p) {
  members(archive, p.translation, p.rotation);
}
template <class Archive>
void describe(Archive& archive, weft::KeyFrame& k) {
  members(archive, k.time, k.translation, k.angles_deg);
}
template <class Archive>
void describe(Archive& archive, KeyFrame& k) {
  members(archive, k.time, k.translation, k.angles_deg);
}
template <class Archive>
void describe(Archive& archive, MeshFrame& f) {
  members(archive, f.time, f.positions);
}
template <class Archive>
void describe(Archive& archive, weft::WindKey& k) {
  members(archive, k.time, k.velocity);
}
template <class Archive>
void describe(Archive& archive, weft::Wind& w) {
  members(archive, w.velocity, w.keys, w.drag, w.air.density, w.air.drag, w.air.lift, w.gusts.strength,
          w.gusts.length, w.gusts.time, w.gusts.seed);
}
template <class Archive>
void describe(Archive& archive, Grid& g) {
  members(archive, g.size_x, g.size_z, g.cells_x, g.cells_z);
}
template <class Archive>
void describe(Archive& archive, weft::TriangleMesh& m) {
  members(archive, m.positions, m.triangles, m.uv);
}
template <class Archive>
void describe(Archive& archive, StretchPoint& p) {
  members(archive, p.strain, p.tension);
}
template <class Archive>
void describe(Archive& archive, Fabric& f) {
  members(archive, f.density, f.c11, f.c22, f.c12, f.g, f.bend_warp, f.bend_weft, f.bend_bias,
          f.bend_hysteresis_warp, f.bend_hysteresis_weft, f.bend_set, f.damping, f.thickness, f.friction,
          f.strain_limit, f.strength, f.stretch_warp, f.stretch_weft);
}
template <class Archive>
void describe(Archive& archive, Springs& s) {
  members(archive, s.density, s.structural, s.shear, s.bend, s.damping, s.damping_kind, s.thickness,
          s.friction);
}
template <class Archive>
void describe(Archive& archive, weft::Seam& s) {
  members(archive, s.a, s.b);
}
template <class Archive>
void describe(Archive& archive, weft::RestScale& s) {
  members(archive, s.vertices, s.warp, s.weft);
}
template <class Archive>
void describe(Archive& archive, ClothDesc& d) {
  members(archive, d.name, d.shape, d.rest, d.rest_scales, d.source, d.fabric, d.fabric_name, d.membrane,
          d.warp, d.model, d.pose, d.velocity, d.weld, d.sew, d.layer, d.seams, d.stitches, d.seam_time,
          d.seam_stiffness, d.fits_thickness);
}
template <class Archive>
void describe(Archive& archive, weft::Sphere& s) {
  members(archive, s.center, s.radius);
}
template <class Archive>
void describe(Archive& archive, weft::Plane& p) {
  members(archive, p.point, p.normal);
}
template <class Archive>
void describe(Archive& archive, weft::Capsule& c) {
  members(archive, c.a, c.b, c.radius);
}
template <class Archive>
void describe(Archive& archive, weft::OrientedBox& b) {
  members(archive, b.center, b.half_size, b.rotation);
}
template <class Archive>
void describe(Archive& archive, AnimationCurve& c) {
  members(archive, c.interpolation, c.times, c.values);
}
template <class Archive>
void describe(Archive& archive, Affine& a) {
  for (int e = 0; e < 12; ++e) archive.plain(a(e / 4, e % 4));
}
template <class Archive>
void describe(Archive& archive, AnimatedNode& n) {
  members(archive, n.parent, n.matrix, n.translation, n.rotation.x(), n.rotation.y(), n.rotation.z(),
          n.rotation.w(), n.scale, n.translations, n.rotations, n.scales, n.weights);
}
template <class Archive>
void describe(Archive& archive, Skin& s) {
  members(archive, s.joints, s.inverse_bind);
}
template <class Archive>
void describe(Archive& archive, Influence& i) {
  members(archive, i.joint, i.weight);
}
template <class Archive>
void describe(Archive& archive, Displacement& d) {
  members(archive, d.vertex, d.by);
}
template <class Archive>
void describe(Archive& archive, SkinnedPart& p) {
  members(archive, p.node, p.skin, p.rest, p.targets, p.weights, p.influences, p.first_influence);
}
template <class Archive>
void describe(Archive& archive, SkinnedMeshDesc& m) {
  members(archive, m.nodes, m.skins, m.parts, m.start, m.end);
}
template <class Archive>
void describe(Archive& archive, VertexMotion& motion) {
  std::optional<SkinnedMeshDesc> desc;
  if (!motion.is_empty()) desc = VertexMotionAccess::source(motion)->desc();
  describe(archive, desc);
  if constexpr (Archive::kReads) {
    if (!desc) return;
    if (!is_valid(*desc)) archive.fail();
    motion = VertexMotionAccess::make(std::make_shared<const SkinnedMesh>(std::move(*desc)));
  }
}
template <class Archive>
void describe(Archive& archive, ColliderDesc& d) {
  members(archive, d.name, d.shape, d.source, d.solid, d.pose, d.motion, d.frames, d.deformation,
          d.deformation_start, d.friction, d.static_friction);
}
template <class Archive>
void describe(Archive& archive, IntegratorSettings& s) {
  members(archive, s.integrator, s.explicit_euler.substeps, s.paper.printed_damping_sign,
          s.implicit_euler.tolerance, s.implicit_euler.iterations, s.newton.iterations, s.newton.quality,
          s.xpbd.substeps, s.is_double);
}
template <class Archive>
void describe(Archive& archive, ContactRule& r) {
  members(archive, r.cloth, r.other_cloth, r.collider, r.friction, r.static_friction, r.collide);
}

template <class Archive>
void describe(Archive& archive, Vec3Array& values) {
  values.resize(describe_size(archive, values.size()));
  for (float* component : {values.x(), values.y(), values.z()}) {
    for (std::size_t i = 0; i < values.size(); ++i) archive.plain(component[i]);
  }
}
template <class Archive>
void describe(Archive& archive, HoldingSide& side) {
  members(archive, side.collider, side.face, side.is_back);
}
template <class Archive>
void describe(Archive& archive, CaughtParticle& p) {
  members(archive, p.particle, p.sides[0], p.sides[1]);
}
template <class Archive>
void describe(Archive& archive, MotionHistory::Pressed& p) {
  members(archive, p.last, p.lasting);
}
template <class Archive>
void describe(Archive& archive, ClothState& s) {
  members(archive, s.origin, s.x, s.v, s.history.step, s.history.had_contact, s.history.displacement,
          s.history.velocity, s.history.pressed, s.precise.x, s.precise.v, s.precise.displacement,
          s.precise.velocity, s.bending.slip, s.bending.set, s.seam_time, s.caught, s.torn);
}
template <class Archive>
void describe(Archive& archive, RigidMotion::Passage& p) {
  members(archive, p.start, p.end, p.from, p.to);
}
template <class Archive>
void describe(Archive& archive, RigidMotion& motion) {
  std::vector<KeyFrame> keys = motion.keys();
  std::optional<RigidMotion::Passage> passage = motion.passage();
  members(archive, keys, passage);
  if constexpr (Archive::kReads) {
    motion = passage ? RigidMotion(passage->start, passage->from, passage->end, passage->to)
                     : RigidMotion(std::move(keys));
  }
}
template <class Archive>
void describe(Archive& archive, MeshSequence::Key& k) {
  members(archive, k.time, k.positions);
}
const std::vector<MeshSequence::Key>& keys_by_hand(const World::Guide& guide) {
  return dynamic_cast<const MeshSequence&>(*guide.source).keys();
}
template <class Archive>
void describe(Archive& archive, Pin& p) {
  members(archive, p.particles, p.motion, p.pivot, p.follow);
}
template <class Archive>
void describe(Archive& archive, SurfaceAnchor& a) {
  members(archive, a.triangle, a.weights, a.offset);
}
template <class Archive>
void describe(Archive& archive, Attachment& g) {
  members(archive, g.particles, g.shares, g.offsets, g.stiffness, g.damping, g.target, g.follow, g.anchor);
}
template <class Archive>
void describe(Archive& archive, PointGuide& g) {
  members(archive, g.from, g.to, g.start, g.end, g.is_new);
}
template <class Archive>
void describe(Archive& archive, Gas& g) {
  members(archive, g.pressure, g.sealed_volume, g.orientation);
}
template <class Archive>
void describe(Archive& archive, World::Held& h) {
  members(archive, h.pins, h.anchors, h.on_surface, h.attachments, h.pin_guide, h.attachment_guide, h.forces,
          h.gas);
}
template <class Archive>
void describe(Archive& archive, World::Guide& g) {
  members(archive, g.moves_by_hand, g.deforms_by_hand, g.pose, g.vertices, g.motion);
  if (!g.deforms_by_hand) return;  // then the source is the description's
  std::vector<MeshSequence::Key> keys;
  if (g.source) keys = keys_by_hand(g);
  describe(archive, keys);
  if constexpr (Archive::kReads) g.source = std::make_shared<const MeshSequence>(std::move(keys));
}
template <class Archive>
void describe(Archive& archive, World::Snapshot& s) {
  members(archive, s.time, s.states, s.held, s.guides, s.part, s.calm);
}

}  // namespace engine

namespace {

using engine::Reader;
using engine::Writer;

constexpr std::uint32_t kMagic = 0x54464557;  // "WEFT"
constexpr std::uint32_t kVersion = 11;        // of the format
constexpr std::size_t kChecksum = sizeof(std::uint64_t);

/// All data that determines the next steps.
struct SavedCloth {
  ClothDesc desc;
  std::vector<Stiffening> stiffened;
  std::vector<char> is_soft;
};

struct SavedWorld {
  Vec3 gravity;
  Wind wind;
  IntegratorSettings integrator;
  StepDivision division;
  ContactSettings contact;
  std::vector<ColliderDesc> colliders;
  std::vector<SavedCloth> cloths;
  std::vector<engine::ContactRule> rules;
  engine::World::Snapshot state;
};

template <class Archive>
void describe(Archive& archive, Stiffening& s) {
  engine::members(archive, s.particles, s.factor);
}
template <class Archive>
void describe(Archive& archive, SavedCloth& c) {
  engine::describe(archive, c.desc);
  const std::size_t count = engine::describe_size(archive, c.stiffened.size());
  c.stiffened.resize(count);
  for (Stiffening& s : c.stiffened) describe(archive, s);
  engine::describe(archive, c.is_soft);
}
template <class Archive>
void describe(Archive& archive, SavedWorld& w) {
  engine::members(archive, w.gravity, w.wind, w.integrator, w.division.enabled, w.division.shortest,
                  w.contact.enabled, w.contact.tracks_points, w.colliders, w.rules);
  const std::size_t count = engine::describe_size(archive, w.cloths.size());
  w.cloths.resize(count);
  for (SavedCloth& c : w.cloths) describe(archive, c);
  engine::describe(archive, w.state);
}

constexpr std::string_view kWhat = "a saved world";

void require(bool condition) {
  if (!condition) Reader({}, kWhat).fail();
}

bool are_finite(const std::vector<engine::Vec3>& points) {
  return std::ranges::all_of(points, [](const engine::Vec3& p) { return p.allFinite(); });
}

void check(const engine::Vec3Array& values, std::size_t count) {
  require(values.size() == count);
  for (std::size_t i = 0; i < count; ++i) require(values.get(i).allFinite());
}

void check(const std::vector<engine::Vec3>& values, std::size_t count) {
  require(values.size() == count && are_finite(values));
}

void check(const engine::ClothState& state, std::size_t count) {
  require(state.origin.allFinite() && std::isfinite(state.history.step) && state.history.step >= 0);
  require(std::isfinite(state.seam_time) && state.seam_time >= 0);
  check(state.x, count);
  check(state.v, count);
  for (const auto* values : {&state.history.displacement, &state.history.velocity})
    check(*values, values->size() == 0 && state.history.step == 0 ? 0 : count);
  for (const std::vector<float>* forces : {&state.history.pressed.last, &state.history.pressed.lasting})
    require(forces->empty() || (forces->size() == count &&
                                std::ranges::all_of(*forces, [](float f) { return std::isfinite(f); })));
  for (const std::vector<float>* curvatures : {&state.bending.slip, &state.bending.set}) {
    require(curvatures->size() == state.bending.slip.size());
    require(std::ranges::all_of(*curvatures, [](float c) { return std::isfinite(c); }));
  }
  for (const auto* values :
       {&state.precise.x, &state.precise.v, &state.precise.displacement, &state.precise.velocity})
    check(*values, values->empty() ? 0 : count);
  for (std::size_t n = 0; n < state.caught.size(); ++n) {
    const engine::CaughtParticle& p = state.caught[n];
    require(p.particle >= 0 && std::cmp_less(p.particle, count));
    require(n == 0 || state.caught[n - 1].particle < p.particle);
    for (const engine::HoldingSide& side : p.sides) require(side.collider >= 0 && side.face >= -1);
  }
}

void check(const engine::PointGuide& guide, std::size_t count) {
  require(std::isfinite(guide.start) && std::isfinite(guide.end));
  for (const auto* points : {&guide.from, &guide.to}) check(*points, guide.is_empty() ? 0 : count);
}

using Colliders = std::vector<engine::Collider>;

/// `follow`: index of a collider, or −1.
void check(const engine::SurfaceAnchor& anchor, int follow, const Colliders& colliders) {
  require(follow >= -1 && std::cmp_less(follow, colliders.size()));
  require(anchor.weights.allFinite() && anchor.offset.allFinite());
  const auto* mesh = follow < 0 ? nullptr : std::get_if<engine::MeshShape>(&colliders[follow].shape);
  require(mesh ? anchor.triangle >= 0 && anchor.triangle < mesh->mesh->num_triangles()
               : anchor.triangle == -1);
}

void check(const engine::World::Held& held, std::size_t num_particles, const std::vector<char>& is_soft,
           const Colliders& colliders) {
  std::size_t pinned = 0;
  for (const engine::Pin& pin : held.pins) {
    require(pin.pivot.allFinite());
    for (std::size_t k = 0; k < pin.particles.size(); ++k, ++pinned) {
      require(pinned < held.on_surface.size());
      check(held.on_surface[pinned], pin.follow, colliders);
    }
  }
  require(held.on_surface.size() == pinned);
  check(held.anchors, pinned);
  require(static_cast<std::size_t>(std::ranges::count(is_soft, 0)) == pinned);
  require(is_soft.size() - pinned == held.attachments.size());
  for (const engine::Attachment& attachment : held.attachments) {
    require(attachment.particles.size() == 1 && attachment.target.allFinite() &&
            are_finite(attachment.offsets));
    check(attachment.anchor, attachment.follow, colliders);
    require(std::ranges::all_of(attachment.shares, [](double share) { return std::isfinite(share); }));
  }
  check(held.pin_guide, pinned);
  check(held.attachment_guide, held.attachments.size());
  check(held.forces, held.forces.empty() ? 0 : num_particles);
  require(std::isfinite(held.gas.pressure) && std::isfinite(held.gas.sealed_volume) &&
          std::abs(held.gas.orientation) == 1);
}

void check(const engine::Pose& pose) {
  require(pose.translation.allFinite() && pose.rotation.allFinite() &&
          (pose.rotation.transpose() * pose.rotation - engine::Mat3::Identity()).cwiseAbs().maxCoeff() <
              1e-6);
}

void check(const engine::World::Guide& guide, const engine::Collider& collider) {
  if (guide.pose) check(*guide.pose);
  if (const auto& passage = guide.motion.passage()) {
    require(std::isfinite(passage->start) && std::isfinite(passage->end));
    check(passage->from);
    check(passage->to);
  }
  const auto* mesh = std::get_if<engine::MeshShape>(&collider.shape);
  require(mesh || (!guide.deforms_by_hand && !guide.vertices));
  if (!mesh) return;
  const auto count = mesh->mesh->positions.size();
  if (guide.vertices) check(*guide.vertices, count);
  if (!guide.deforms_by_hand) return;
  for (const engine::MeshSequence::Key& key : engine::keys_by_hand(guide)) {
    require(std::isfinite(key.time));
    check(key.positions, count);
  }
}

/// Checks the sizes of lists first, so that bodies without a state are never built.
void check_sizes(const SavedWorld& saved) {
  const engine::World::Snapshot& state = saved.state;
  require(state.states.size() == saved.cloths.size() && state.held.size() == saved.cloths.size());
  require(state.guides.size() == saved.colliders.size());
  for (std::size_t c = 0; c < saved.cloths.size(); ++c) {
    const Grid* grid = std::get_if<Grid>(&saved.cloths[c].desc.shape);
    if (!grid) continue;
    require(grid->cells_x > 0 && grid->cells_z > 0);
    const double least = (grid->cells_x + 1.0) * (grid->cells_z + 1.0),
                 found = static_cast<double>(state.states[c].x.size());
    require(state.states[c].torn.empty() ? least == found : least <= found);
  }
}

void check(const SavedWorld& saved, const engine::World& world) {
  const engine::World::Snapshot& state = saved.state;
  require(std::isfinite(state.time) && std::isfinite(state.part) && state.part >= 0);
  for (std::size_t c = 0; c < saved.cloths.size(); ++c) {
    const ClothId cloth = world.cloth(static_cast<int>(c));
    const auto count = world.can_tear(cloth) ? state.states[c].x.size()  // World::restore() checks it
                                             : static_cast<std::size_t>(world.model(cloth).num_particles());
    check(state.states[c], count);
    check(state.held[c], count, saved.cloths[c].is_soft, world.colliders());
  }
  for (std::size_t c = 0; c < saved.colliders.size(); ++c) check(state.guides[c], world.colliders()[c]);
}

BodyId body(const World& world, int cloth, int collider) {
  if (cloth >= 0) return world.cloth(cloth);
  return world.collider(collider);
}

void apply(const engine::ContactRule& rule, World& world) {
  const BodyId a = body(world, rule.cloth, -1), b = body(world, rule.other_cloth, rule.collider);
  if (rule.friction) world.set_friction(a, b, *rule.friction, rule.static_friction.value_or(0));
  world.set_collision(a, b, rule.collide);
}

}  // namespace

std::vector<std::byte> World::save() const {
  const engine::World& world = impl_->world;
  SavedWorld saved{.gravity = engine::from_engine(world.gravity()),
                   .wind = impl_->wind,
                   .integrator = world.integrator(),
                   .division = world.division(),
                   .contact = {world.has_contact(), world.tracks_contacts()},
                   .rules = world.rules(),
                   .state = world.snapshot()};
  for (const Impl::Collider& c : impl_->colliders) saved.colliders.push_back(c.desc);
  for (const Impl::Cloth& c : impl_->cloths) {
    saved.cloths.push_back({c.desc, c.stiffened, c.is_soft});
  }
  Writer writer;
  writer.plain(kMagic);
  writer.plain(kVersion);
  describe(writer, saved);
  writer.plain(engine::hash_of<std::byte>(writer.bytes));
  return std::move(writer.bytes);
}

World World::load(std::span<const std::byte> bytes) {
  require(bytes.size() > 2 * sizeof(std::uint32_t) + kChecksum);
  Reader head(bytes, kWhat);
  std::uint32_t magic = 0, version = 0;
  head.plain(magic);
  head.plain(version);
  require(magic == kMagic);
  if (version != kVersion)
    throw InputError("the saved world has format version " + std::to_string(version) +
                     "; this library reads version " + std::to_string(kVersion));
  std::uint64_t sum = 0;
  Reader(bytes.last(kChecksum), kWhat).plain(sum);
  require(sum == engine::hash_of<std::byte>(bytes.first(bytes.size() - kChecksum)));
  Reader reader(
      bytes.subspan(2 * sizeof(std::uint32_t), bytes.size() - 2 * sizeof(std::uint32_t) - kChecksum), kWhat);
  SavedWorld saved;
  describe(reader, saved);
  require(reader.left() == 0);
  check_sizes(saved);

  World world;
  engine::World& inside = world.impl_->world;
  world.set_gravity(saved.gravity);
  world.set_integrator(saved.integrator);
  world.set_division(saved.division);
  world.set_contact(saved.contact);
  for (ColliderDesc& desc : saved.colliders) world.impl_->add(std::move(desc));
  for (SavedCloth& cloth : saved.cloths) {
    const ClothId id = world.impl_->add(std::move(cloth.desc));
    for (const Stiffening& s : cloth.stiffened) world.stiffen(id, s.particles, s.factor);
    world.impl_->cloths.back().is_soft = cloth.is_soft;
  }
  for (std::size_t c = 0; c < inside.colliders().size(); ++c) {
    const auto* mesh = std::get_if<engine::MeshShape>(&inside.colliders()[c].shape);
    if (mesh && !saved.state.guides[c].deforms_by_hand) saved.state.guides[c].source = mesh->source;
  }
  for (const engine::ContactRule& rule : saved.rules) apply(rule, world);
  check(saved, inside);
  inside.restore(saved.state);
  world.set_wind(saved.wind);
  return world;
}

}  // namespace weft
