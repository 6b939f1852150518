#include "weft/run/live_instruments.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "weft/error.h"
#include "weft/face/world_impl.h"
#include "weft/scene/scene_world.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

std::vector<std::vector<float>> read_colors(ParticleValue value, const World& world) {
  std::vector<std::vector<float>> values;
  for (int c = 0; c < world.num_cloths(); ++c) values.push_back(compute_values(value, world, world.cloth(c)));
  return values;
}

std::vector<YarnCross> read_yarns(const World& world) {
  std::vector<YarnCross> crosses;
  for (int c = 0; c < world.num_cloths(); ++c) {
    const ClothModel& model = world.model(world.cloth(c));
    const ClothState& state = world.state(world.cloth(c));
    const std::vector<Triangle>& triangles = model.topology->mesh.triangles;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const std::optional<Yarns> yarns = find_yarns(model, state, static_cast<int>(t));
      if (!yarns) break;
      const Vec3 a = state.position(triangles[t][0]), b = state.position(triangles[t][1]),
                 d = state.position(triangles[t][2]);
      crosses.push_back({(a + b + d) / 3, *yarns, std::sqrt(0.5 * (b - a).cross(d - a).norm())});
    }
  }
  return crosses;
}

ProbeReading read_probe(const World& world, const ClothPoint& at, const std::vector<LivePins>& pins) {
  const ClothId cloth = world.cloth(at.cloth);
  const ClothModel& model = world.model(cloth);
  const ClothState& state = world.state(cloth);
  const Triangle& corners = model.topology->mesh.triangles[at.triangle];
  ProbeReading reading{
      .cloth = world.name(cloth), .triangle = at.triangle, .particle = corners[at.nearest_corner()]};
  for (int k = 0; k < 3; ++k) reading.point += at.weights[k] * state.position(corners[k]);
  reading.velocity = state.v.get(reading.particle);
  reading.yarns = find_yarns(model, state, at.triangle);
  reading.mass = model.mass[reading.particle];
  reading.is_pinned =
      std::ranges::find(pins[at.cloth].particles, reading.particle) != pins[at.cloth].particles.end();
  if (!world.tracks_contacts()) return reading;
  Vec3& sum = reading.contact.emplace(Vec3::Zero());
  for (const ContactPoint& contact : world.contact_points()) {
    if (contact.cloth == at.cloth && contact.particle == reading.particle) sum += contact.force;
    if (contact.other_cloth == at.cloth && contact.other_vertex == reading.particle) sum -= contact.force;
  }
  return reading;
}

bool is_on(const ClothPoint& point, const World& world) {
  return point.cloth < world.num_cloths() &&
         point.triangle <
             static_cast<int>(world.model(world.cloth(point.cloth)).topology->mesh.triangles.size());
}

}  // namespace

void read_instruments(const World& world, const LiveInstruments& wanted, const std::vector<LivePins>& pins,
                      LiveFrame& frame) {
  frame.meshes.values.clear();
  frame.contacts.clear();
  frame.yarns.clear();
  frame.probe.reset();
  frame.no_color.clear();
  try {
    if (wanted.color) frame.meshes.values = read_colors(*wanted.color, world);
  } catch (const InputError& error) {
    frame.no_color = error.what();
  }
  if (wanted.yarns) frame.yarns = read_yarns(world);
  if (wanted.probe && is_on(*wanted.probe, world)) frame.probe = read_probe(world, *wanted.probe, pins);
  if (!wanted.contacts) return;
  for (const ContactPoint& contact : world.contact_points())
    frame.contacts.push_back({contact.position, contact.force});
}

void measure_world(const weft::World& world, LiveSample& sample) {
  sample.is_measured = true;
  sample.energies = world.energies();
  const World& engine = WorldAccess::engine(world);
  for (int c = 0; c < engine.num_cloths(); ++c) {
    const ClothId cloth = engine.cloth(c);
    sample.strain =
        std::max(sample.strain, compute_yarn_strain(engine.model(cloth), engine.state(cloth)).max);
  }
}

std::vector<LivePins> find_pins(const SceneDesc& scene, const weft::World& world) {
  std::vector<LivePins> all;
  for (int c = 0; c < world.num_cloths(); ++c) {
    const ClothId id = world.cloth(c);
    LivePins pins;
    const std::vector<int>& particle_of_vertex = world.notes(id).particle_of_vertex;
    pins.vertex_of_particle.resize(world.num_particles(id), -1);
    for (std::size_t v = particle_of_vertex.size(); v-- > 0;) {
      if (particle_of_vertex[v] >= 0) pins.vertex_of_particle[particle_of_vertex[v]] = static_cast<int>(v);
    }
    for (const weft::Pin& pin : describe_pins(scene.cloths[c], id, world)) {
      std::vector<int>& vertices = pins.vertices.emplace_back();
      for (const int particle : pin.particles) vertices.push_back(pins.vertex_of_particle[particle]);
      pins.particles.insert(pins.particles.end(), pin.particles.begin(), pin.particles.end());
    }
    std::ranges::sort(pins.particles);
    pins.particles.erase(std::unique(pins.particles.begin(), pins.particles.end()), pins.particles.end());
    all.push_back(std::move(pins));
  }
  return all;
}

std::vector<SeamEdges> find_seams(const weft::World& world) {
  std::vector<SeamEdges> all;
  for (int c = 0; c < world.num_cloths(); ++c) {
    const ClothId id = world.cloth(c);
    const std::vector<weft::Triangle>& triangles = world.triangles(id);
    const std::vector<weft::CornerUv> uv = world.uv(id);
    SeamEdges& seams = all.emplace_back();
    using End = std::array<double, 2>;
    std::map<std::array<int, 2>, std::array<End, 2>> first;  // texture coordinates of the first triangle
    for (std::size_t t = 0; t < uv.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        std::array<int, 2> edge = {triangles[t][k], triangles[t][(k + 1) % 3]};
        std::array<End, 2> ends = {uv[t][k], uv[t][(k + 1) % 3]};
        if (edge[0] > edge[1]) {
          std::swap(edge[0], edge[1]);
          std::swap(ends[0], ends[1]);
        }
        const auto [at, is_new] = first.try_emplace(edge, ends);
        if (!is_new && at->second != ends) seams.push_back(edge);
      }
    }
  }
  return all;
}

}  // namespace weft::engine
