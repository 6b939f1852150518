/// World::untangle: repair of intersected cloth in a separate stage world, without gravity or wind.
///
/// 1. Solids that cloth is in become thinner, until cloth is outside (contact/shrink.h).
/// 2. Remaining intersections, of cloth with cloth or with primitive shapes, are repaired
///    (contact/untangle.h).
/// 3. The solids grow back, step by step, and push cloth in front of them; its strain relaxes meanwhile, and
///    afterwards until it is small or no longer falls. After each step all velocities are set to zero.
///
/// The state with fewer intersections, start or end, is kept.

#include <algorithm>
#include <limits>

#include "weft/animation/mesh_sequence.h"
#include "weft/contact/shrink.h"
#include "weft/mesh/solid.h"
#include "weft/world/measures.h"
#include "weft/world/world.h"

namespace weft::engine {
namespace {

constexpr double kStep = 1.0 / 60;     // of the stage world [s]
constexpr double kGrowth = 1.5e-3;     // per step, approximately [m]
constexpr int kMaxSteps = 54;          // of growth …
constexpr int kMaxSettling = 24;       // … and after it, …
constexpr double kRelaxed = 0.05;      // … until strain is no larger [1], …
constexpr int kMaxStalled = 4;         // … or has not fallen for so many steps …
constexpr double kFalls = 0.99;        // … below this share of the least so far
constexpr double kMoreThanDeep = 1.2;  // factor on the penetration depth by which solids become thinner …
constexpr double kRoom = 2e-3;         // … and addition to it [m]
constexpr double kMoreNextTime = 1.6;  // factor if that was not enough
constexpr int kMaxTrials = 3;

/// The collider at its present pose, static.
Collider still(const Collider& collider, double time) {
  Collider result = collider;
  result.shape = shape_at(collider, time);
  result.motion = {};
  if (MeshShape* shape = std::get_if<MeshShape>(&result.shape)) {
    TriangleMesh mesh = *shape->mesh;
    for (int v = 0; v < mesh.num_vertices(); ++v) mesh.positions[v] = shape->vertex(v);
    *shape = {.mesh = std::make_shared<const TriangleMesh>(std::move(mesh))};
  }
  return result;
}

/// A mesh that grows from thinner vertices.
MeshShape growing_from(const std::vector<Vec3>& thin, const MeshShape& full, int steps) {
  MeshShape shape = full;
  shape.source = std::make_shared<const MeshSequence>(
      std::vector<MeshSequence::Key>{{0, thin}, {steps * kStep, full.mesh->positions}});
  return shape;
}

/// Penetration depth of cloth in each collider (colliders) [m]; 0 for none.
std::vector<double> compute_depths(const Intersections& intersections, std::size_t num_colliders) {
  std::vector<double> depths(num_colliders, 0.0);
  for (const Inside& inside : intersections.inside)
    depths[inside.collider] = std::max(depths[inside.collider], inside.depth);
  return depths;
}

/// The largest strain of a cloth, in any direction where it has membranes, of yarns where its mesh is not at rest [1].
double compute_largest_strain(const ClothModel& model, const ClothState& state) {
  const bool is_at_rest = model.topology->mesh.at_rest.empty();
  const std::optional<Stretches> stretches =
      is_at_rest ? compute_principal_stretches(model, state) : std::nullopt;
  return stretches ? stretches->max - 1 : compute_yarn_strain(model, state).max;
}

double compute_largest_strain(const World& world) {
  double largest = 0;
  for (int c = 0; c < world.num_cloths(); ++c) {
    const ClothId cloth = world.cloth(c);
    largest = std::max(largest, compute_largest_strain(world.model(cloth), world.state(cloth)));
  }
  return largest;
}

}  // namespace

Intersections World::find_intersections() {
  show_contact_cloths();
  Intersections intersections = contact_system_.find_intersections(
      contact_cloths_, colliders_, {.time = time_, .step = 1, .rules = rules_}, *jobs_);
  std::erase_if(intersections.inside, [](const Inside& inside) { return inside.depth <= kTouches; });
  return intersections;
}

/// A world with the same cloths in place, at rest, and the same colliders, static; no other forces.
World World::make_stage() const {
  World stage;
  stage.jobs_ = jobs_;
  stage.rules_ = rules_;
  stage.gravity_.setZero();
  stage.set_division({.shortest = kStep / 16});
  for (const Collider& collider : colliders_) stage.add_collider(still(collider, time_));
  for (const Cloth& cloth : cloths_) {
    const ClothId id = stage.add_cloth({.name = cloth.name,
                                        .topology = cloth.model->topology,
                                        .material = cloth.model->material,
                                        .elements = cloth.model->elements,
                                        .positions = positions_of(cloth.state),
                                        .layer = cloth.layer});
    Pin held;
    for (const PinnedParticle& pinned : cloth.pinned) held.particles.push_back(pinned.particle);
    stage.set_pins(id, {held});
  }
  return stage;
}

/// Replaces the meshes that cloth is in by thinner ones, which grow back from the stage's start. Returns the
/// number of steps that they take.
int World::thin_colliders(const Intersections& crossed, World& stage) const {
  int most_steps = 0;
  const std::vector<double> depths = compute_depths(crossed, colliders_.size());
  for (std::size_t c = 0; c < colliders_.size(); ++c) {
    MeshShape* shape = std::get_if<MeshShape>(&stage.colliders_[c].shape);
    if (!shape || depths[c] == 0) continue;
    stage.colliders_[c].friction = stage.colliders_[c].static_friction = 0;
    const MeshShape full = *shape;
    const TriangleMesh solid = find_solid_part(*full.mesh);
    double depth = kMoreThanDeep * depths[c] + kRoom;
    double most = depth / kMaxShrinkage;
    for (int trial = 1; trial < kMaxTrials; ++trial) most *= kMoreNextTime;
    const std::vector<double> radii = compute_inner_radii(solid, most, *jobs_);
    int steps = 0;
    for (int trial = 0; trial < kMaxTrials; ++trial, depth *= kMoreNextTime) {
      steps = std::clamp(static_cast<int>(depth / kGrowth), 1, kMaxSteps);
      *shape = growing_from(weft::engine::shrink(solid, radii, depth), full, steps);
      if (compute_depths(stage.find_intersections(), colliders_.size())[c] == 0) break;
    }
    most_steps = std::max(most_steps, steps);
  }
  return most_steps;
}

/// Sets all velocities to zero.
void World::halt() {
  for (Cloth& cloth : cloths_) {
    for (std::size_t i = 0; i < cloth.state.v.size(); ++i) cloth.state.v.set(i, Vec3::Zero());
    cloth.state.history.step = 0;
  }
}

UntangleReport World::untangle(const std::function<void(int round)>& on_round) {
  UntangleReport report;
  const Intersections crossed = find_intersections();
  if (crossed.empty()) return report;
  report.crossed = report.left = describe(crossed);
  World stage = make_stage();
  const int growing = thin_colliders(crossed, stage);
  stage.show_contact_cloths();
  report.rounds = stage.contact_system_
                      .untangle(stage.contact_cloths_, stage.colliders_, {.step = 1, .rules = stage.rules_},
                                *jobs_, on_round)
                      .rounds;
  double least = std::numeric_limits<double>::infinity();
  int stalled = 0;
  for (int s = 0; s < growing + kMaxSettling; ++s) {
    if (s > growing) {
      const double strain = compute_largest_strain(stage);
      stalled = strain < kFalls * least ? 0 : stalled + 1;
      if (strain <= kRelaxed || stalled == kMaxStalled) break;
      least = std::min(least, strain);
    }
    stage.halt();
    if (!stage.step(kStep).ok) break;
    ++report.rounds;
    if (on_round) on_round(report.rounds);
  }
  const Snapshot before = snapshot();
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    ClothState& state = cloths_[c].state;
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      const Vec3 place = stage.cloths_[c].state.position(i);
      report.farthest = std::max(report.farthest, (place - state.position(i)).norm());
      state.set_position(i, place);
    }
    state.history.step = 0;
  }
  const Intersections left = find_intersections();
  if (left.is_better_than(crossed)) {
    report.left = describe(left);
  } else {
    restore(before);
    report.farthest = 0;
  }
  return report;
}

}  // namespace weft::engine
