/// ContactSystem's contact points, and the repair of initial intersections.

#include <algorithm>
#include <tuple>

#include "weft/contact/contact_system.h"

namespace weft::engine {

void ContactSystem::add_contact_force(const Constraint& c, const Vec3& force) {
  if (!step_.tracks || force.isZero(0)) return;
  contact_forces_.push_back({c.vertex, c.weight, c.num_vertices, c.shape, c.normal, force});
}

std::vector<ContactPoint> ContactSystem::contact_points() const {
  std::vector<ContactForce> forces = contact_forces_;
  const auto key = [](const ContactForce& t) { return std::tie(t.shape, t.num_vertices, t.vertex); };
  std::stable_sort(forces.begin(), forces.end(),
                   [&](const ContactForce& a, const ContactForce& b) { return key(a) < key(b); });
  std::vector<ContactPoint> points;
  for (std::size_t t = 0; t < forces.size(); ++t) {
    ContactForce sum = forces[t];
    while (t + 1 < forces.size() && key(forces[t + 1]) == key(sum)) sum.force += forces[++t].force;
    points.push_back(describe(sum));
  }
  return points;
}

ContactPoint ContactSystem::describe(const ContactForce& contact) const {
  struct Side {
    Vec3 point = Vec3::Zero();
    int vertex = -1;  // the one with the greatest weight
    double weight = 0;
  };
  Side sides[2];
  for (int k = 0; k < contact.num_vertices; ++k) {
    Side& side = sides[contact.weight[k] < 0 ? 1 : 0];
    const double weight = std::abs(contact.weight[k]);
    side.point += weight * motion_.end[contact.vertex[k]];
    if (side.vertex >= 0 && weight <= side.weight) continue;
    side.vertex = contact.vertex[k];
    side.weight = weight;
  }
  ContactPoint point{.normal = contact.normal, .force = contact.force};
  point.position = contact.shape >= 0 ? sides[0].point : Vec3(0.5 * (sides[0].point + sides[1].point));
  if (place_of(sides[0].vertex).cloth < 0) {  // reported from the cloth's side
    std::swap(sides[0], sides[1]);
    point.normal = -point.normal;
    point.force = -point.force;
  }
  const Place own = place_of(sides[0].vertex);
  point.cloth = own.cloth;
  point.particle = own.index;
  point.collider = contact.shape;
  if (contact.shape >= 0) return point;
  const Place other = place_of(sides[1].vertex);
  point.other_cloth = other.cloth;
  point.collider = other.collider;
  point.other_vertex = other.index;
  return point;
}

ContactSystem::Place ContactSystem::place_of_triangle(int triangle) const {
  Place place = place_of(surface().triangles[triangle][0]);
  int first = triangle;
  const auto is_of_it = [&](int t) {
    const Place other = place_of(surface().triangles[t][0]);
    return other.cloth == place.cloth && other.collider == place.collider;
  };
  while (first > 0 && is_of_it(first - 1)) --first;
  place.index = triangle - first;
  return place;
}

/// Call it after begin_step.
RepairInput ContactSystem::make_repair_input() const {
  RepairInput input{.surface = &surface(),
                    .first_vertex = first_vertex_,
                    .num_cloth_vertices = first_vertex_.back(),
                    .inverse_mass = &inverse_mass_,
                    .half_thickness = &motion_.half_thickness};
  const auto non_colliding = [this](const Place& cloth, const Place& other) {
    return !pair_settings_[pair_index(cloth, other)].collide;
  };
  input.non_colliding = [this, non_colliding](int v, int w) {
    return non_colliding(place_of(std::min(v, w)), place_of(std::max(v, w)));
  };
  input.non_colliding_solid = [this, non_colliding](int v, int collider) {
    return non_colliding(place_of(v), {.collider = collider});
  };
  for (const ContactCloth& cloth : cloths_) {
    const TriangleMesh& mesh = cloth.model->topology->mesh;
    input.num_cloth_triangles += mesh.num_triangles();
    input.rest.insert(input.rest.end(), mesh.positions.begin(), mesh.positions.end());
    input.origins.insert(input.origins.end(), mesh.positions.size(), cloth.state->origin);
  }
  for (int s = 0; s < static_cast<int>(shapes_.size()); ++s) {
    if (!shapes_[s].is_mesh()) input.solids.push_back({s, shapes_[s].after});
  }
  for (const Body& body : bodies_) {
    input.first_vertex.push_back(body.end_vertex);
    if (!body.is_closed) continue;
    input.solids.push_back({body.collider, shapes_[body.collider].after, body.first_vertex, body.end_vertex});
  }
  return input;
}

/// Positions of cloth and of colliders now. Call it after begin_step.
std::vector<Vec3> ContactSystem::positions_now() const {
  std::vector<Vec3> positions = motion_.end;
  std::copy_n(motion_.start.begin(), first_vertex_.back(), positions.begin());
  return positions;
}

Intersections ContactSystem::find_intersections(std::span<const ContactCloth> cloths,
                                                const std::vector<Collider>& colliders,
                                                const ContactStep& now) {
  begin_step(cloths, colliders, now);
  if (!is_placed_) place();
  return weft::engine::find_intersections(make_repair_input(), positions_now());
}

UntangleResult ContactSystem::untangle(std::span<const ContactCloth> cloths,
                                       const std::vector<Collider>& colliders, const ContactStep& now) {
  begin_step(cloths, colliders, now);
  if (!is_placed_) place();
  std::vector<Vec3> positions = positions_now();
  const UntangleResult result = weft::engine::untangle(make_repair_input(), positions);
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    ClothState& state = *cloths_[c].state;
    for (int i = 0, v = first_vertex_[c]; v < first_vertex_[c + 1]; ++i, ++v) {
      if (positions[v] == motion_.start[v]) continue;
      state.set_position(i, positions[v]);
      state.history.step = 0;
    }
  }
  return result;
}

}  // namespace weft::engine
