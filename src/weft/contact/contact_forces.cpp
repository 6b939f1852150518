#include "weft/contact/contact_forces.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace weft::engine {

void ContactForces::add(const Constraint& c, const Vec3& force) {
  if (!force.isZero(0)) forces_.push_back({c.vertex, c.weight, c.num_vertices, c.shape, c.normal, force});
}

std::vector<ContactPoint> ContactForces::points(const StepBodies& bodies) const {
  std::vector<Force> forces = forces_;
  const auto key = [](const Force& t) { return std::tie(t.shape, t.num_vertices, t.vertex); };
  std::stable_sort(forces.begin(), forces.end(),
                   [&](const Force& a, const Force& b) { return key(a) < key(b); });
  std::vector<ContactPoint> points;
  for (std::size_t t = 0; t < forces.size(); ++t) {
    Force sum = forces[t];
    while (t + 1 < forces.size() && key(forces[t + 1]) == key(sum)) sum.force += forces[++t].force;
    points.push_back(describe(sum, bodies));
  }
  return points;
}

ContactPoint ContactForces::describe(const Force& contact, const StepBodies& bodies) {
  struct Side {
    Vec3 point = Vec3::Zero();
    int vertex = -1;  // the one with the greatest weight
    double weight = 0;
  };
  Side sides[2];
  for (int k = 0; k < contact.num_vertices; ++k) {
    Side& side = sides[contact.weight[k] < 0 ? 1 : 0];
    const double weight = std::abs(contact.weight[k]);
    side.point += weight * bodies.motion.end[contact.vertex[k]];
    if (side.vertex >= 0 && weight <= side.weight) continue;
    side.vertex = contact.vertex[k];
    side.weight = weight;
  }
  ContactPoint point{.normal = contact.normal, .force = contact.force};
  point.position = contact.shape >= 0 ? sides[0].point : Vec3(0.5 * (sides[0].point + sides[1].point));
  if (!bodies.numbering.is_of_cloth(sides[0].vertex)) {  // reported from the cloth's side
    std::swap(sides[0], sides[1]);
    point.normal = -point.normal;
    point.force = -point.force;
  }
  const BodyPlace own = bodies.numbering.place_of(sides[0].vertex);
  point.cloth = own.cloth;
  point.particle = own.index;
  point.collider = contact.shape;
  if (contact.shape >= 0) return point;
  const BodyPlace other = bodies.numbering.place_of(sides[1].vertex);
  point.other_cloth = other.cloth;
  point.collider = other.collider;
  point.other_vertex = other.index;
  return point;
}

}  // namespace weft::engine
