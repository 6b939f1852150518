#pragma once
/// The bodies of a step and their motion: what the stages of contact read.

#include <vector>

#include "weft/contact/constraint.h"
#include "weft/contact/moving_shape.h"
#include "weft/contact/numbering.h"
#include "weft/contact/pair_settings.h"
#include "weft/contact/proximity.h"

namespace weft::engine {

/// What constraints are generated for.
enum class Purpose {
  solve,        // the likely contacts, for an integrator's solve
  after_solve,  // what such a solve left
  projection,   // all contacts of a step whose solve knew none
};

struct StepBodies {
  Numbering numbering;
  const Surface* surface = nullptr;
  std::vector<ContactCloth> cloths;
  std::vector<MovingShape> shapes;   // (colliders)
  SurfaceMotion motion;              // from the start to the end of the step, as far as it is known
  std::vector<double> inverse_mass;  // (num_vertices) 0 where prescribed [1/kg]
  PairTable pairs;
  std::vector<Vec3> velocity_before;  // (num_vertices) at the start [m/s]; empty without static friction
  double thinnest = 0, thickest = 0;  // half thickness of the thinnest and the thickest cloth [m]
  double step = 0;                    // [s]

  int num_cloths() const { return static_cast<int>(cloths.size()); }
  int num_cloth_vertices() const { return numbering.num_cloth_vertices(); }
  bool has_plain_shapes() const;

  /// Calls body(cloth, its particle, vertex) for all particles.
  template <class Body>
  void for_particles(const Body& body) const {
    for (int c = 0; c < num_cloths(); ++c) {
      for (int v = numbering.first_vertex[c]; v < numbering.first_vertex[c + 1]; ++v)
        body(c, v - numbering.first_vertex[c], v);
    }
  }

  /// Mean velocity of a collider mesh's vertex in the step [m/s].
  Vec3 mean_velocity(int vertex) const { return (motion.end[vertex] - motion.start[vertex]) / step; }

  /// Friction coefficient: the static one if the two did not slide at the start of the step [1].
  double friction_of(const PairSettings& settings, const Constraint& c) const;

  /// Whether a shape is a ball or a capsule with a radius well above the cloth's cells: particles alone keep the cloth
  /// out of it in a solve.
  bool is_round(int shape, int vertex) const;

  /// How much more than half the thickness a particle therefore keeps from a shape, so that the triangles between
  /// particles do not sag in; 0 if the shape is not round, or without a solve [m].
  double lift_of(int shape, int vertex, Purpose purpose) const;
  /// An upper bound for all particles and shapes [m].
  double most_lift() const;

  /// Required distance from a primitive shape [m].
  double clearance_of(const Constraint& c, Purpose purpose) const;

  /// Regular distance between a constraint's features [m].
  double gap_of(const Constraint& c, Purpose purpose) const;

  /// How far the features end beyond the constraint's plane; negative on the free side [m].
  double depth_at_end(const Constraint& c) const { return c.target - c.normal.dot(c.sum(motion.end)); }
};

/// The share of the gap that cloth must keep from a collider. After a solve less than all: a contact's depth is its
/// force, and the next step's friction starts from it [1].
double required_share(Purpose purpose);

}  // namespace weft::engine
