#include "weft/integrators/solver_budget.h"

#include <algorithm>
#include <cmath>

namespace weft::engine {
namespace {

/// Measured on the hanging sheet (docs/explanation/method.md): 10 iterations at 2000 N/m and 60 steps per
/// second, where `stiffness_number` is 13.7, half as many at 200 N/m and twice as many at 20000.
constexpr double kUsualStiffnessNumber = 13.7;
constexpr double kUsualIterations = 10;
constexpr double kSecondStepStiffnessNumber = 70;  // from here on a second Newton step pays off

/// Where the usual iterations are too few (pins in the middle of the cloth, noise), up to this many times as
/// many are made, as long as they still lower the potential.
constexpr int kMaxIterationFactor = 4;
constexpr int kMinIterations = 5;

/// With many short Newton steps contacts and their slides are found sooner than with few long ones.
constexpr double kShareInContact = 0.8;  // of the usual iterations, at least …
constexpr int kMinIterationsInContact = 8;

/// Iterations end below this share of the total decrease so far [1].
double enough_for(NewtonQuality quality) {
  switch (quality) {
    case NewtonQuality::fast:
      return 1e-2;
    case NewtonQuality::high:
      return 3e-4;
    case NewtonQuality::normal:
      break;
  }
  return 3e-3;
}

/// Minimum share of the usual iterations: near rest each gains little, but the gains add up.
int min_iterations_for(NewtonQuality quality, int usual) {
  return quality == NewtonQuality::fast ? (usual + 1) / 2 : (3 * usual + 3) / 4;
}

}  // namespace

double compute_stiffness_rate(const ClothModel& model) {
  double stiffness = 0, mass = 0;
  for (int i = 0; i < model.num_particles(); ++i) {
    stiffness += model.stiffness_sum[i];
    mass += model.mass[i];
  }
  return stiffness / mass / model.num_particles();
}

SolverBudget choose_budget(const NewtonSettings& settings, double stiffness_number) {
  constexpr double kMaxIterations = 60;
  SolverBudget budget;
  if (settings.iterations > 0) {
    budget.free = {settings.iterations, 0};
    budget.in_contact = {std::max(settings.iterations, kMinIterationsInContact), 0};
    return budget;
  }
  // The power 5/16 by square roots: bit-identical on all platforms.
  const double fourth = std::sqrt(std::sqrt(stiffness_number / kUsualStiffnessNumber));
  const double usual = std::min(kUsualIterations * fourth * std::sqrt(std::sqrt(fourth)), kMaxIterations);
  const int iterations = std::max(static_cast<int>(std::lround(usual)), kMinIterations);
  budget.free = {kMaxIterationFactor * iterations, enough_for(settings.quality),
                 min_iterations_for(settings.quality, iterations)};
  budget.in_contact = {
      std::max(static_cast<int>(std::lround(kShareInContact * usual)), kMinIterationsInContact), 0};
  const bool is_stiff =
      stiffness_number > kSecondStepStiffnessNumber && settings.quality != NewtonQuality::fast;
  if (is_stiff || settings.quality == NewtonQuality::high) budget.newton_steps = 2;
  return budget;
}

}  // namespace weft::engine
