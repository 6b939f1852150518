#pragma once
/// Contact projection: separates positions that end too close, removes approaching velocities, and slows sliding
/// ones by friction.

#include <vector>

#include "weft/contact/constraint.h"
#include "weft/contact/step_bodies.h"
#include "weft/contact/velocity_projection.h"

namespace weft::engine {

class ContactProjection {
 public:
  /// Projects predicted end positions, roughly. Returns whether a vertex left the reach of the contact search.
  bool project_prediction(StepBodies& bodies, std::vector<Constraint>& constraints);

  /// Begins the projection of a step: reads velocities.
  void begin(const StepBodies& bodies);

  /// Takes constraints from a contact search at the present end positions.
  void take(const StepBodies& bodies, std::vector<Constraint>& constraints);

  /// Separates end positions. Planes of round shapes are updated in between.
  void settle(StepBodies& bodies, Purpose purpose, std::vector<Constraint>& constraints);

  /// Projects velocities, and sets the constraints' impulses. End positions lose the slides that friction
  /// prevents, so that sticking cloth does not creep.
  void project_velocities(StepBodies& bodies, std::vector<Constraint>& constraints);

  /// Whether a vertex was moved so far that contacts must be searched again: by more than half of the search
  /// margin.
  bool has_left_reach(const StepBodies& bodies) const;

  /// Stores positions and velocities in the cloths' states.
  void store(const StepBodies& bodies);

 private:
  void mark_touched(const std::vector<Constraint>& constraints);

  VelocityProjection velocity_projection_;
  std::vector<Vec3> searched_;           // end positions of the last contact search [m]
  std::vector<char> is_touched_;         // (num_vertices) by a constraint
  std::vector<Quad> velocity_, slowed_;  // (num_vertices) [m/s]
  std::vector<int> near_, count_;        // work space of project_positions and mark_alone
};

}  // namespace weft::engine
