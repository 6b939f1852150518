#pragma once
/// Narrow phase of primitive shapes: spheres, planes, capsules and boxes, against particles and triangles.

#include <span>
#include <vector>

#include "weft/contact/caught_particles.h"
#include "weft/contact/shape_clearance.h"
#include "weft/contact/step_bodies.h"

namespace weft::engine {

/// Updates a constraint's plane: the tangent plane of its shape at the point nearest to the particle or triangle at
/// the end of the step.
void update_plane(const StepBodies& bodies, Purpose purpose, Constraint& c);

/// Distance of a constraint's feature from its shape at the start of the step [m].
double distance_at_start(const StepBodies& bodies, const Constraint& c);

class ShapeConstraints {
 public:
  struct Input {
    const StepBodies& bodies;
    const CaughtParticles& caught;  // have no constraints with what holds them
    Purpose purpose;
    double share_of_travel;  // of a particle's motion that adds to its reach, twice the gap and the lift [1]
  };

  /// Begins a step, in which vertices start within `travel` of where they started the one before (see
  /// ShapeClearance::begin_step).
  void begin_step(const StepBodies& bodies, double travel);

  /// Appends constraints, shape after shape. `longest_edge`: upper bound for cloth edges [m]. Returns whether any
  /// vertex is near a shape.
  bool generate(const Input& in, double longest_edge, std::vector<Constraint>& constraints);

  /// Of particles between two colliders takes back the lift (StepBodies::lift_of), so that cloth fits wherever its
  /// thickness does; triangles there get constraints in a solve, too. Particles that were between colliders in
  /// the constraints `before` stay so. `constraints` are complete; those lowered already stay as they are.
  void lower_between(const Input& in, std::span<const Constraint> before,
                     std::vector<Constraint>& constraints) const;

  /// Of cloth from the shapes, as measured so far.
  const ShapeClearance& clearance() const { return clearance_; }

 private:
  void generate_for(const Input& in, int shape, double longest_edge, std::vector<Constraint>& constraints);
  void generate_for_triangles(const Input& in, int shape, double longest_edge,
                              std::vector<Constraint>& constraints) const;

  ShapeClearance clearance_;

  // Work space.
  std::vector<int> near_;         // vertices that may come near to the shape
  std::vector<double> distance_;  // (cloth vertices) from the shape [m]
};

}  // namespace weft::engine
