#pragma once
/// Gas inside closed cloth. Its energy and force: forces/pressure.h.

namespace weft::engine {

struct Gas {
  double pressure = 0;       // kept excess over the air outside; not in use for sealed gas [Pa]
  double sealed_volume = 0;  // at which sealed gas has the pressure of the air; 0: the pressure is kept [m³]
  double orientation = 1;    // −1: the cloth faces inwards; the volume is the mesh's times this

  bool is_sealed() const { return sealed_volume > 0; }
  bool is_active() const { return pressure != 0 || is_sealed(); }
  bool operator==(const Gas&) const = default;
};

}  // namespace weft::engine
