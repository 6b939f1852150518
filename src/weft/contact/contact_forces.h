#pragma once
/// The contact forces of a step, and the contact points that are reported from them.

#include <vector>

#include "weft/contact/constraint.h"
#include "weft/contact/contact_point.h"
#include "weft/contact/step_bodies.h"

namespace weft::engine {

class ContactForces {
 public:
  void clear() { forces_.clear(); }

  /// Adds a force on the feature of a constraint that has positive weights [N].
  void add(const Constraint& c, const Vec3& force);

  /// All contacts, each pair of features once, with its sum of forces.
  std::vector<ContactPoint> points(const StepBodies& bodies) const;

 private:
  /// A contact force between two features, or on one.
  struct Force {
    std::array<int, 4> vertex;  // as in Constraint
    std::array<double, 4> weight;
    int num_vertices, shape;
    Vec3 normal;
    Vec3 force;  // on the feature with positive weights [N]
  };

  static ContactPoint describe(const Force& contact, const StepBodies& bodies);

  std::vector<Force> forces_;
};

}  // namespace weft::engine
