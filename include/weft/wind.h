#pragma once
/// Wind, and aerodynamic drag and lift.

#include <cstdint>
#include <vector>

#include "weft/vec.h"

namespace weft {

/// Drag and lift per triangle; supported by `newton` and `implicit_euler`.
struct Air {
  double density = 0;  // of air about 1.2; 0: no drag and lift [kg/m³]
  double drag = 1.2;   // C_D of a plate face-on; > 0 [1]
  double lift = 0.6;   // C_L; from 0 to `drag`. Higher: glides sideways as it falls, flutters [1]
  bool operator==(const Air&) const = default;
};

/// Velocity fluctuation about zero in space and time: smooth noise, the same for the same numbers.
struct Gusts {
  double strength = 0;     // root mean square along each axis; 0: none [m/s]
  double length = 1;       // correlation length; longer: broader gusts; > 0 [m]
  double time = 0.5;       // correlation time; longer: slower gusts; > 0 [s]
  std::uint64_t seed = 1;  // another seed: other gusts
  bool operator==(const Gusts&) const = default;
};

struct WindKey {
  double time = 0;     // [s]
  Vec3 velocity = {};  // [m/s]
};

struct Wind {
  Vec3 velocity = {};              // of the air, without keys [m/s]
  std::vector<WindKey> keys = {};  // by rising times; linear between, constant outside; empty: `velocity`
  double drag = 0;                 // c_w, force per area and relative velocity, >= 0 [N·s/m³]
  Air air = {};
  Gusts gusts = {};  // added to `velocity`; only `air` uses them
};

}  // namespace weft
