#pragma once
/// Private to forces/: the strain limit (fabric/membrane_law.h) for the kernels.

#include "weft/core/pack.h"
#include "weft/fabric/membrane_law.h"

namespace weft::engine::kernels {

/// StrainLimit in floats.
struct LimitNumbers {
  float begin = 0, width = 1, stiffness = 0;

  LimitNumbers() = default;
  explicit LimitNumbers(const StrainLimit& limit) {
    if (limit.stiffness == 0) return;
    begin = static_cast<float>(limit.begin);
    width = static_cast<float>(limit.full - limit.begin);
    stiffness = static_cast<float>(limit.stiffness);
  }

  bool is_set() const { return stiffness > 0; }
};

/// limit_response() of a pack of strains.
template <int W>
struct LimitPull {
  Pack<W> energy, tension, stiffness;
};

template <int W>
WEFT_ALWAYS_INLINE LimitPull<W> limit_pull(const LimitNumbers& n, Pack<W> strain) {
  const Pack<W> u = larger(strain - n.begin, broadcast<W>(0)), m = smaller(u, broadcast<W>(n.width)),
                over = u - m;
  const float k = n.stiffness, per_width = k / n.width;
  return {per_width * m * m * m * (1.0f / 6) + over * (0.5f * k) * (m + over),
          0.5f * per_width * m * m + k * over, per_width * m};
}

}  // namespace weft::engine::kernels
