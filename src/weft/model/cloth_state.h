#pragma once
/// What moves: positions and velocities of one cloth. Everything constant is in ClothModel.

#include "weft/core/hash.h"
#include "weft/core/vec3_array.h"
#include "weft/model/cloth_model.h"

namespace weft::engine {

/// What the step before has left for an integrator of second order. Any other may leave it alone.
struct MotionHistory {
  double step = 0;           // length of the step before, 0: there is none to go by [s]
  bool had_contact = false;  // contact took part in it
  bool is_held = false;      // hands act in the step to come, whose balance is that of implicit Euler
  Vec3Array displacement;    // x now − x before it (num_particles) [m]
  Vec3Array velocity;        // v before it (num_particles) [m/s]
};

/// The same numbers as ClothState and its history have, in doubles: for integrators that work in double
/// precision (num_particles each; empty: there are none). An entry counts as long as it rounds to the float
/// beside it: whoever moves a particle by its float need not know of this.
struct PreciseState {
  std::vector<Vec3> x, v, displacement, velocity;
};

/// Positions are float offsets from a double origin, so that cloth far from the world's origin keeps its
/// precision.
struct ClothState {
  Vec3 origin = Vec3::Zero();  // [m]
  Vec3Array x;                 // offset of each particle from `origin` (num_particles) [m]
  Vec3Array v;                 // velocity (num_particles) [m/s]
  MotionHistory history;       // to be dropped (step = 0) where positions or velocities are set from outside
  PreciseState precise;

  Vec3 position(std::size_t i) const { return origin + x.get(i); }
  void set_position(std::size_t i, const Vec3& position) { x.set(i, position - origin); }
};

/// At rest at the given positions (num_particles) [m], with the origin among them.
ClothState make_state(const std::vector<Vec3>& positions);

/// What `precise` has for element i of `values`, or the float if that is newer.
Vec3 most_precise(const std::vector<Vec3>& precise, const Vec3Array& values, std::size_t i);

/// Moves the origin along with a cloth whose middle has travelled more than 2 m from it. Positions move by
/// at most half a unit in the last place of their new offset.
void follow_cloth(ClothState& state);

void add_to_hash(const ClothState& state, Hash& hash);

}  // namespace weft::engine
