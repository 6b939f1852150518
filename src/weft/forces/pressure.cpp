#include "weft/forces/pressure.h"

#include <cmath>
#include <limits>

namespace weft::engine {

Gas seal_gas(double pressure, double volume) {
  return {.pressure = 0, .sealed_volume = (1 + pressure / kAirPressure) * volume};
}

double gas_energy(const Gas& gas, double volume) {
  if (!gas.is_sealed()) return -gas.pressure * volume;
  if (!(volume > 0)) return std::numeric_limits<double>::infinity();
  const double growth = volume / gas.sealed_volume - 1;
  return kAirPressure * gas.sealed_volume * (growth - std::log1p(growth));
}

double gas_excess(const Gas& gas, double volume) {
  return gas.is_sealed() ? kAirPressure * (gas.sealed_volume / volume - 1) : gas.pressure;
}

double gas_stiffness(const Gas& gas, double volume) {
  return gas.is_sealed() ? kAirPressure * gas.sealed_volume / (volume * volume) : 0;
}

}  // namespace weft::engine
