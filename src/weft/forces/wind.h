#pragma once
/// Wind (the paper's Eq. 4), per area and thus independent of the mesh; aerodynamic drag and lift.

#include <span>

#include "weft/core/vec.h"
#include "weft/forces/air.h"

namespace weft::engine {

struct Wind {
  Vec3 velocity = Vec3::Zero();  // of the air [m/s]
  double drag = 0;               // c_w, force per area and relative velocity, >= 0 [N·s/m³]
  Air air = {};                  // per triangle; supported by `newton` and `implicit_euler`
  Gusts gusts = {};              // added to `velocity`; only `air` uses them
};

struct WindKey {
  double time = 0;               // [s]
  Vec3 velocity = Vec3::Zero();  // [m/s]
  bool operator==(const WindKey&) const = default;
};

/// The velocity at a time: linear between keys, constant outside. At least one key.
Vec3 wind_velocity(std::span<const WindKey> keys, double time);

/// c_w A (v_wind − v) [N] on a particle of area A [m²]. Still air brakes too.
inline Vec3 wind_force(const Wind& wind, double area, const Vec3& velocity) {
  return wind.drag * area * (wind.velocity - velocity);
}

/// ∂f/∂v = −c_w A I [N·s/m].
inline Mat3 wind_jacobian(const Wind& wind, double area) { return -wind.drag * area * Mat3::Identity(); }

}  // namespace weft::engine
