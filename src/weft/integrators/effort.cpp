#include "weft/integrators/effort.h"

#include <algorithm>
#include <cmath>

namespace weft {
namespace {

/// Measured on the hanging sheet (docs/method.md): 10 iterations at 2000 N/m and 60 steps per second, where
/// this number is 13.7, half as many at 200 N/m and twice as many at 20000.
constexpr double kUsualStiffness = 13.7;
constexpr double kUsualIterations = 10;
constexpr double kExponent = 0.3;
constexpr double kStiff = 70;  // from here on a second Newton step pays

}  // namespace

Effort choose_effort(const NewtonSettings& settings, const ClothModel& model, double step) {
  constexpr int kMost = 60;
  Effort effort;
  const double stiffness = compute_stiffness_number(model, step) / model.num_particles();
  const double wanted = kUsualIterations * std::pow(stiffness / kUsualStiffness, kExponent);
  const double factor = settings.quality == NewtonQuality::fast ? 0.5 : settings.quality == NewtonQuality::high ? 2 : 1;
  effort.linear.iterations = std::clamp(static_cast<int>(std::lround(factor * wanted)), 3, kMost);
  const bool is_stiff = stiffness > kStiff && settings.quality != NewtonQuality::fast;
  if (is_stiff || settings.quality == NewtonQuality::high) effort.newton_steps = 2;
  if (settings.iterations > 0) {
    effort.linear.iterations = settings.iterations;
    effort.newton_steps = 1;
  }
  return effort;
}

}  // namespace weft
