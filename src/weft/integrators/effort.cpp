#include "weft/integrators/effort.h"

#include <algorithm>
#include <cmath>

namespace weft {
namespace {

/// Measured on the hanging sheet (docs/method.md): 10 iterations at 2000 N/m and 60 steps per second, where
/// this number is 13.7, half as many at 200 N/m and twice as many at 20000.
constexpr double kUsualReach = 13.7;
constexpr double kUsualIterations = 10;
constexpr double kStiffReach = 70;  // from here on a second Newton step pays

}  // namespace

double compute_reach_rate(const ClothModel& model) {
  double stiffness = 0, mass = 0;
  for (int i = 0; i < model.num_particles(); ++i) {
    stiffness += model.stiffness_sum[i];
    mass += model.mass[i];
  }
  return stiffness / mass / model.num_particles();
}

Effort choose_effort(const NewtonSettings& settings, double reach) {
  constexpr int kMost = 60;
  Effort effort;
  // The power 5/16, by square roots: they have the same bits everywhere.
  const double fourth = std::sqrt(std::sqrt(reach / kUsualReach));
  const double wanted = kUsualIterations * fourth * std::sqrt(std::sqrt(fourth));
  const double factor = settings.quality == NewtonQuality::fast   ? 0.5
                        : settings.quality == NewtonQuality::high ? 2
                                                                  : 1;
  effort.linear.iterations = std::clamp(static_cast<int>(std::lround(factor * wanted)), 3, kMost);
  const bool is_stiff = reach > kStiffReach && settings.quality != NewtonQuality::fast;
  if (is_stiff || settings.quality == NewtonQuality::high) effort.newton_steps = 2;
  if (settings.iterations > 0) {
    effort.linear.iterations = settings.iterations;
    effort.newton_steps = 1;
  }
  return effort;
}

}  // namespace weft
