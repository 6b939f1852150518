#include "lab/textile/drape.h"

#include <algorithm>
#include <cmath>

#include "weft/core/random.h"
#include "weft/mesh/sample_meshes.h"
#include "weft/world/world.h"

namespace weft::engine::lab {
namespace {

constexpr double kPlateRadius = 0.09, kSpecimenRadius = 0.15;  // of ISO 9073-9 [m]
constexpr int kRings = 30;
constexpr double kPi = 3.141592653589793;
constexpr double kCrease = 2e-4;       // of the specimens at the start [m]
constexpr double kCrookedness = 0.25;  // of random meshes, as a share of the distance of rings [1]
constexpr double kFps = 960,
                 kMaxSeconds = 8;    // short steps, because the formation of folds determines the final shape
constexpr double kAirRate = 10;      // damping rate by air drag: about half of critical [1/s]
constexpr double kRestSpeed = 1e-3;  // [m/s]
constexpr double kLoweringTime = 3, kLowering = 0.1;  // of the support [s], [m]
constexpr double kPixel = 5e-4;                       // of the shadow [m]

/// A specimen on its plates. Bending stencils of the last held ring extend half a ring beyond it. Therefore
/// the edge of the plates is half a ring further in.
struct Disc {
  TriangleMesh mesh;
  std::vector<char> is_held;  // (num_vertices)
  int num_hem = 0;            // vertices of the outermost ring, the last ones
};

Disc make_disc(const SpecimenSettings& settings) {
  const int rings = settings.resolution > 0 ? settings.resolution : kRings;
  const int held = static_cast<int>(std::lround(rings * kPlateRadius / kSpecimenRadius));
  const double outside = (kSpecimenRadius - kPlateRadius) / (rings - held + 0.5);
  const double inside = (kPlateRadius + outside / 2) / held;
  Disc disc{.mesh = build_disc_mesh(rings, rings), .is_held = {}, .num_hem = 6 * rings};
  for (Vec3& p : disc.mesh.positions) {
    const double ring = p.norm();
    const bool is_held = ring < held + 0.5;
    disc.is_held.push_back(is_held);
    if (ring > 0) p *= (is_held ? inside * ring : kPlateRadius + outside * (ring - held + 0.5)) / ring;
  }
  if (settings.mesh == SpecimenMesh::grid) return disc;
  Random random(1);
  const int num_held = static_cast<int>(std::count(disc.is_held.begin(), disc.is_held.end(), 1));
  const double size = kCrookedness * kSpecimenRadius / rings;
  for (int i = num_held; i < disc.mesh.num_vertices() - disc.num_hem; ++i)  // the plates' edge stays round
    disc.mesh.positions[i] += Vec3(random.uniform(-size, size), 0, random.uniform(-size, size));
  return disc;
}

/// A table under the specimen that sinks away from it. A fabric with memory would keep the folds of a free fall.
Collider make_support(const Fabric& fabric) {
  const double below = kCrease + fabric.thickness;
  return {.name = "support",
          .shape = Plane{.point = {0, -below, 0}, .normal = Vec3::UnitY()},
          .friction = 0,
          .motion = RigidMotion({{.time = 0}, {.time = kLoweringTime, .translation = {0, -kLowering, 0}}})};
}

World make_world(const Fabric& fabric, const Disc& disc, double warp_deg, std::uint64_t seed, int threads) {
  const TriangleMesh& mesh = disc.mesh;
  const auto topology = build_mesh_topology(mesh);
  const double angle = warp_deg * kPi / 180;
  const Vec3 warp(std::cos(angle), 0, std::sin(angle));
  World world;
  world.set_jobs(make_jobs(threads));
  world.set_wind({Vec3::Zero(), kAirRate * fabric.density});
  Random random(seed);
  Pin plates;
  std::vector<Vec3> positions = mesh.positions;
  for (int i = 0; i < mesh.num_vertices(); ++i) {
    const double crease = random.uniform(-kCrease, kCrease);
    if (disc.is_held[i]) {
      plates.particles.push_back(i);
    } else {
      positions[i].y() += crease;
    }
  }
  const ClothId cloth =
      world.add_cloth({.topology = topology,
                       .material = {.density = fabric.density,
                                    .structural = 0,
                                    .shear = 0,
                                    .bend = 0,
                                    .thickness = fabric.thickness,
                                    .friction = fabric.friction},
                       .elements = build_mesh_elements(mesh, warp_from_direction(mesh, warp), fabric),
                       .positions = positions});
  world.set_pins(cloth, {plates});
  if (has_bending_memory(fabric)) world.add_collider(make_support(fabric));
  return world;
}

double largest_speed(const ClothState& state) {
  double largest = 0;
  for (std::size_t i = 0; i < state.v.size(); ++i) largest = std::max(largest, state.v.get(i).norm());
  return largest;
}

bool settle(World& world) {
  for (int step = 0; step < kFps * kMaxSeconds; ++step) {
    world.step(1 / kFps);
    if (step > kFps && largest_speed(world.state(world.cloth(0))) < kRestSpeed) return true;
  }
  return false;
}

/// Number of crossings of the hem from above to below its mean height.
int count_nodes(const ClothState& state, int num_hem) {
  const std::size_t first = state.x.size() - static_cast<std::size_t>(num_hem);
  double mean = 0;
  for (std::size_t i = first; i < state.x.size(); ++i) mean += state.position(i).y() / num_hem;
  int nodes = 0;
  bool was_above = state.position(state.x.size() - 1).y() > mean;
  for (std::size_t i = first; i < state.x.size(); ++i) {
    const bool is_above = state.position(i).y() > mean;
    nodes += was_above && !is_above;
    was_above = is_above;
  }
  return nodes;
}

/// The side of a directed edge on which a point of the plane lies.
double side(const Vec2& a, const Vec2& b, const Vec2& p) {
  return (b.x() - a.x()) * (p.y() - a.y()) - (b.y() - a.y()) * (p.x() - a.x());
}

}  // namespace

double compute_shadow(const std::vector<Triangle>& triangles, const ClothState& state) {
  std::vector<Vec2> places;
  Eigen::AlignedBox2d box;
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    places.emplace_back(state.position(i).x(), state.position(i).z());
    box.extend(places.back());
  }
  const int columns = static_cast<int>(box.sizes().x() / kPixel) + 2;
  const int rows = static_cast<int>(box.sizes().y() / kPixel) + 2;
  std::vector<char> is_dark(static_cast<std::size_t>(columns) * rows, 0);
  for (const auto& [i, j, k] : triangles) {
    const Vec2 &a = places[i], &b = places[j], &c = places[k];
    const Eigen::AlignedBox2d around = Eigen::AlignedBox2d(a).extend(b).extend(c);
    const Vec2 low = (around.min() - box.min()) / kPixel, high = (around.max() - box.min()) / kPixel;
    for (int y = static_cast<int>(low.y()); y <= static_cast<int>(high.y()); ++y) {
      for (int x = static_cast<int>(low.x()); x <= static_cast<int>(high.x()); ++x) {
        const Vec2 p = box.min() + kPixel * Vec2(x + 0.5, y + 0.5);
        const double ab = side(a, b, p), bc = side(b, c, p), ca = side(c, a, p);
        const bool is_inside = (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
        if (is_inside) is_dark[static_cast<std::size_t>(y) * columns + x] = 1;
      }
    }
  }
  return kPixel * kPixel * static_cast<double>(std::count(is_dark.begin(), is_dark.end(), 1));
}

Animation show_specimen(const ClothModel& model, const ClothState& state) {
  AnimatedCloth cloth{
      .name = "specimen", .triangles = model.topology->mesh.triangles, .color = {0.04, 0.12, 0.30}};
  cloth.frames.emplace_back();
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    for (const double c : state.position(i)) cloth.frames[0].push_back(static_cast<float>(c));
    const Vec3& rest = model.topology->mesh.positions[i];
    for (const double c : {rest.x(), rest.z()}) cloth.fabric_coordinates.push_back(static_cast<float>(c));
  }
  Animation animation;
  animation.cloths.push_back(std::move(cloth));
  return animation;
}

Drape simulate_drape(const Fabric& fabric, const SpecimenSettings& settings, std::uint64_t seed,
                     int threads) {
  const Disc disc = make_disc(settings);
  World world = make_world(fabric, disc, settings.warp_deg, seed, threads);
  Drape drape;
  drape.is_at_rest = settle(world);
  const ClothModel& model = world.model(world.cloth(0));
  const ClothState& state = world.state(world.cloth(0));
  const double plates = kPi * kPlateRadius * kPlateRadius;
  const double flat = kPi * kSpecimenRadius * kSpecimenRadius;
  drape.coefficient = (compute_shadow(model.topology->mesh.triangles, state) - plates) / (flat - plates);
  drape.nodes = count_nodes(state, disc.num_hem);
  drape.specimen = show_specimen(model, state);
  return drape;
}

}  // namespace weft::engine::lab
