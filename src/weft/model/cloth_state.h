#pragma once
/// Variables of one cloth: positions and velocities. Constants are in ClothModel.

#include <array>
#include <vector>

#include "weft/core/hash.h"
#include "weft/core/vec3_array.h"
#include "weft/model/cloth_model.h"

namespace weft::engine {

/// History of the previous step, for second-order integrators and for contact. Others may ignore it.
struct MotionHistory {
  /// Normal forces of cloth on the particles, of each the mean over its contacts; in the last step, and the
  /// smaller ones of the last two (num_particles; empty: none) [N].
  struct Pressed {
    std::vector<float> last, lasting;
  };

  double step = 0;           // length of the previous step; 0: no history [s]
  bool had_contact = false;  // contact took part in it
  bool is_held = false;      // a grab acts in the next step, which then uses the balance of implicit Euler
  Vec3Array displacement;    // x now − x before it (num_particles) [m]
  Vec3Array velocity;        // v before it (num_particles) [m/s]
  Pressed pressed;           // only after solves with contacts
};

/// ClothState and its history in doubles, for integrators that work in double precision (num_particles each;
/// may be empty). An entry is valid while it rounds to the corresponding float: code that moves a particle by
/// its float needs no update here.
struct PreciseState {
  std::vector<Vec3> x, v, displacement, velocity;
};

/// Bending of the threads until now, of each row of ThreadBends; empty: straight from the beginning.
struct BendingMemory {
  std::vector<float> slip;  // curvature at which friction is zero [1/m]
  std::vector<float> set;   // curvature at rest [1/m]
};

/// A surface that holds a caught particle.
struct HoldingSide {
  int collider = 0;      // number
  int face = -1;         // a triangle of its mesh; of a box 0 to 5: +x, −x, +y, …; -1 of other shapes
  bool is_back = false;  // the particle came from behind the triangle, of an open mesh
};

/// A particle caught between two surfaces of colliders that overlap, or leave less room than it is thick.
struct CaughtParticle {
  int particle = 0;
  std::array<HoldingSide, 2> sides;
};

/// Positions are float offsets from a double origin, so that cloth far from the world's origin keeps its
/// precision.
struct ClothState {
  Vec3 origin = Vec3::Zero();  // [m]
  Vec3Array x;                 // offset of each particle from `origin` (num_particles) [m]
  Vec3Array v;                 // velocity (num_particles) [m/s]
  MotionHistory history;       // reset (step = 0) when positions or velocities are set from outside
  PreciseState precise;
  BendingMemory bending;
  double seam_time = 0;                // since seams began to close; 0 without seams [s]
  std::vector<CaughtParticle> caught;  // in ascending order of particles
  std::vector<int> torn;               // edges of the whole mesh that broke (mesh/tear.h)

  Vec3 position(std::size_t i) const { return origin + x.get(i); }
  void set_position(std::size_t i, const Vec3& position) { x.set(i, position - origin); }
};

/// Positions of all particles (num_particles) [m].
std::vector<Vec3> positions_of(const ClothState& state);

/// A state at rest at the given positions (num_particles) [m], with the origin at their centre.
ClothState make_state(const std::vector<Vec3>& positions);

/// Element i of `precise`, or the float in `values` if it is newer.
Vec3 most_precise(const std::vector<Vec3>& precise, const Vec3Array& values, std::size_t i);

/// Moves the origin along with a cloth whose centre is more than 2 m from it. Positions change by at most
/// half a unit in the last place of their new offset.
void follow_cloth(ClothState& state);

void add_to_hash(const ClothState& state, Hash& hash);

}  // namespace weft::engine
