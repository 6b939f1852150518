#include "weft/forces/wind.h"

namespace weft::engine {

Vec3 wind_velocity(std::span<const WindKey> keys, double time) {
  std::size_t next = 0;
  while (next < keys.size() && keys[next].time <= time) ++next;
  const WindKey& a = keys[next == 0 ? 0 : next - 1];
  const WindKey& b = keys[next == keys.size() ? next - 1 : next];
  const double span = b.time - a.time;
  const double s = span > 0 ? (time - a.time) / span : 0.0;
  return a.velocity + s * (b.velocity - a.velocity);
}

}  // namespace weft::engine
