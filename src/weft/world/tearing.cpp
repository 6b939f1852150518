/// World: cloth that tears.

#include <algorithm>

#include "weft/forces/cuts.h"
#include "weft/mesh/tear.h"
#include "weft/world/world.h"
#include "weft/world/world_input.h"

namespace weft::engine {
namespace {

/// Edges of the whole mesh, and its vertices by particle of torn cloth.
struct WholeMesh {
  std::vector<Edge> edges;
  std::vector<int> vertex;
};

/// Of the cuts those at the ends of tears, and the worst of the others: where one tear begins, tension beside it falls.
std::vector<Cut> choose(const std::vector<Cut>& cuts, const WholeMesh& whole,
                        const std::vector<int>& broken) {
  std::vector<char> is_at_tear(whole.vertex.size(), 0);
  for (const int e : broken) is_at_tear[whole.edges[e].a] = is_at_tear[whole.edges[e].b] = 1;
  std::vector<Cut> chosen;
  const Cut* worst = nullptr;
  for (const Cut& cut : cuts) {
    if (is_at_tear[whole.vertex[cut.particle]])
      chosen.push_back(cut);
    else if (!worst || cut.tension > worst->tension)
      worst = &cut;
  }
  if (worst) chosen.push_back(*worst);
  return chosen;
}

/// Breaks the edges of the cuts, beside those that are broken. Returns all of them.
std::vector<int> break_edges(const std::vector<Cut>& cuts, const WholeMesh& whole, std::vector<int> broken) {
  for (const Cut& cut : cuts) {
    for (const int end : cut.ends) {
      if (end < 0) continue;
      const auto [a, b] = std::minmax(whole.vertex[cut.particle], whole.vertex[end]);
      const auto found = std::ranges::lower_bound(whole.edges, std::pair(a, b), {},
                                                  [](const Edge& e) { return std::pair(e.a, e.b); });
      broken.push_back(static_cast<int>(found - whole.edges.begin()));
    }
  }
  std::ranges::sort(broken);
  broken.erase(std::unique(broken.begin(), broken.end()), broken.end());
  return broken;
}

/// Moves the parts of particles apart, at most by `most` each [m].
void open_tears(const std::vector<Triangle>& triangles, const std::vector<int>& sources, double most,
                ClothState& state) {
  std::vector<int> num_parts(sources.size(), 0);
  for (const int source : sources) ++num_parts[source];
  std::vector<char> is_part;
  for (const int source : sources) is_part.push_back(num_parts[source] > 1);
  std::vector<Vec3> positions = positions_of(state);
  draw_in(triangles, is_part, positions);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!is_part[i]) continue;
    const Vec3 from = state.position(i), way = positions[i] - from;
    state.set_position(i, from + std::min(1.0, most / std::max(way.norm(), most)) * way);
  }
}

void move(const std::vector<int>& to, std::vector<int>& particles) {
  for (int& i : particles) i = to[i];
}

}  // namespace

bool World::can_tear() const {
  return std::ranges::any_of(cloths_, [](const Cloth& cloth) { return cloth.tearing != nullptr; });
}

void World::set_material(ClothId id, const ClothMaterial& material,
                         std::shared_ptr<const TearingCloth> tearing) {
  Cloth& cloth = at(id);
  require_valid(material, cloth.name);
  ClothModel changed = *cloth.model;
  changed.material = material;
  auto model = build_torn_model(*tearing, changed, cloth.state.torn);
  require_elements_supported(integrator_settings_.integrator, *model->elements, cloth.name);
  cloth.model = std::move(model);
  cloth.tearing = std::move(tearing);
  set_acceleration(cloth);
}

/// The cloth's model with these broken edges: its present one, if they are those of its state.
std::shared_ptr<const ClothModel> World::model_for(const Cloth& cloth, const std::vector<int>& torn) {
  if (torn == cloth.state.torn) return cloth.model;
  require(cloth.tearing != nullptr, "cloth \"" + cloth.name + "\" does not tear");
  const bool ascends = std::ranges::adjacent_find(torn, std::ranges::greater_equal{}) == torn.end();
  require(ascends && (torn.empty() || torn.front() >= 0),
          "cloth \"" + cloth.name + "\": numbers of torn edges must ascend");
  return build_torn_model(*cloth.tearing, *cloth.model, torn);
}

ClothState World::split(ClothId id, const ClothState& state) const {
  const Cloth& cloth = at(id);
  if (state.torn == cloth.state.torn) return state;
  const RestMesh before = tear_mesh(cloth.tearing->whole->mesh, state.torn);
  const std::vector<Triangle>& now = cloth.model->topology->mesh.triangles;
  return split_particles(state, find_same_corners(now, cloth.model->num_particles(), before.triangles),
                         cloth.state.torn);
}

/// Tears all cloths where their tension exceeds their strength. Returns the number of cuts.
int World::tear() {
  int count = 0;
  for (int c = 0; c < num_cloths(); ++c) {
    if (cloths_[c].tearing) count += tear(cloth(c));
  }
  return count;
}

/// Particles that are pinned or sewn stay whole: no cut goes through them, or to them.
int World::tear(ClothId id) {
  Cloth& cloth = at(id);
  std::vector<char> holds = cloth.is_pinned;
  for (const SeamSpring& seam : cloth.model->topology->seams.springs) {
    for (const int i : seam.particles) holds[i] = 1;
  }
  const std::vector<Cut> found = find_cuts(*cloth.model, cloth.state, holds, cloth.tearing->fabric.strength);
  if (found.empty()) return 0;
  Held held = this->held(id);
  const RestMesh &mesh = cloth.tearing->whole->mesh, &before = cloth.model->topology->mesh;
  const WholeMesh whole{build_edges(mesh),
                        find_same_corners(before.triangles, before.num_vertices(), mesh.triangles)};
  const std::vector<Cut> cuts = choose(found, whole, cloth.state.torn);
  std::vector<int> broken = break_edges(cuts, whole, cloth.state.torn);
  const std::shared_ptr<const ClothModel> model = build_torn_model(*cloth.tearing, *cloth.model, broken);
  const std::vector<Triangle>& triangles = model->topology->mesh.triangles;
  const std::vector<int> to = find_same_corners(before.triangles, before.num_vertices(), triangles);
  const std::vector<int> sources = find_same_corners(triangles, model->num_particles(), before.triangles);
  ClothState state = split_particles(cloth.state, sources, std::move(broken));
  open_tears(triangles, sources, cloth.model->material.thickness / 4, state);
  for (Pin& pin : held.pins) move(to, pin.particles);
  for (Attachment& attachment : held.attachments) move(to, attachment.particles);
  if (!held.forces.empty()) {
    std::vector<Vec3> forces(sources.size(), Vec3::Zero());
    for (std::size_t i = 0; i < held.forces.size(); ++i) forces[to[i]] = held.forces[i];
    held.forces = std::move(forces);
  }
  held.gas = {};
  for (CaughtParticle& caught : state.caught) caught.particle = to[caught.particle];
  std::ranges::sort(state.caught, {}, &CaughtParticle::particle);
  cloth.model = model;
  cloth.state = std::move(state);
  hold(id, std::move(held));
  return static_cast<int>(cuts.size());
}

}  // namespace weft::engine
