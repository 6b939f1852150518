#include "weft/core/simd.h"

#include <algorithm>

namespace weft::engine {
namespace {

SimdLevel detect() {
#if WEFT_HAS_SIMD_LEVELS
  __builtin_cpu_init();
  if (__builtin_cpu_supports("x86-64-v4")) return SimdLevel::avx512;
  if (__builtin_cpu_supports("x86-64-v3")) return SimdLevel::avx2;
#endif
  return SimdLevel::baseline;
}

SimdLevel& level_in_use() {
  static SimdLevel level = detect();
  return level;
}

}  // namespace

SimdLevel best_simd_level() {
  static const SimdLevel best = detect();
  return best;
}

SimdLevel simd_level() { return level_in_use(); }

void limit_simd_level(SimdLevel level) { level_in_use() = std::min(level, best_simd_level()); }

std::string_view to_string(SimdLevel level) {
  switch (level) {
    case SimdLevel::avx512:
      return "avx512";
    case SimdLevel::avx2:
      return "avx2";
    case SimdLevel::baseline:
      break;
  }
  return "baseline";
}

}  // namespace weft::engine
