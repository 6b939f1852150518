#include "lab/benchmarks/random_scenes.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "lab/benchmarks/random_scene.h"
#include "weft/core/job_system.h"

namespace weft::engine::lab {
namespace {

constexpr double kMaxGainOfOneStep = 0.1,
                 kMaxGainOfTenSteps = 0.01;  // energy gain, share of energy in motion
constexpr double kMaxSpeedError = 0.01;      // of free fall
constexpr int kWindow = 10;                  // steps

/// Maxima over the steps of a scene.
struct Outcome {
  bool is_finite = true;
  double gain = 0;              // of one step, as a share of the energy in motion [1]
  double mean_gain = 0;         // of ten steps [1]
  std::optional<double> speed;  // error of free fall, as a share [1]
};

/// Energy error of stiff springs by rounding to floats, 1e-7 m [J].
double energy_noise(const RandomScene& scene) { return 1e-9 * scene.cloth.model->material.structural; }

double mean_of_last(const std::vector<double>& values, int count) {
  double sum = 0;
  for (std::size_t i = values.size() - count; i < values.size(); ++i) sum += values[i];
  return sum / count;
}

Outcome run(RandomScene scene, const RandomBenchOptions& options) {
  HungCloth& cloth = scene.cloth;
  const auto integrator = make_integrator({.integrator = options.integrator});
  const auto jobs = make_serial_jobs();
  const int substeps = integrator->num_substeps(*cloth.model, cloth.environment, scene.step);
  const double start = scene.energy(), start_height = scene.height_energy(),
               start_speed = scene.vertical_speed();
  double lowest = start_height;
  Outcome outcome;
  std::vector<double> gains;
  for (int s = 0; s < options.steps; ++s) {
    for (int u = 0; u < substeps; ++u)
      integrator->advance(*cloth.model, cloth.environment, scene.step / substeps, *jobs, cloth.state);
    const double energy = scene.energy();
    outcome.is_finite = std::isfinite(energy);
    if (!outcome.is_finite) return outcome;
    lowest = std::min(lowest, scene.height_energy());
    const double in_motion = start - lowest + energy_noise(scene);
    gains.push_back((energy - start) / in_motion);
    outcome.gain = std::max(outcome.gain, gains.back());
    if (s + 1 >= kWindow) outcome.mean_gain = std::max(outcome.mean_gain, mean_of_last(gains, kWindow));
  }
  if (cloth.environment.pins.particle.empty()) {
    const double expected = -9.81 * options.steps * scene.step;
    outcome.speed = std::abs((scene.vertical_speed() - start_speed) / expected - 1);
  }
  return outcome;
}

std::string describe(const RandomScene& scene) {
  const ClothModel& model = *scene.cloth.model;
  return fmt::format("{} particles, {:.2g} N/m, {:.2g} kg/m², step 1/{:.0f} s, damping {:.2g}, {} pins",
                     model.num_particles(), model.material.structural, model.material.density, 1 / scene.step,
                     model.material.damping, scene.cloth.environment.pins.particle.size());
}

}  // namespace

bool bench_random(const RandomBenchOptions& options) {
  int infinite = 0, gaining = 0, gaining_on_average = 0, falling_wrong = 0, free_pieces = 0;
  for (int s = 0; s < options.scenes; ++s) {
    const auto seed = static_cast<std::uint64_t>(options.first_seed + s);
    const RandomScene scene = make_random_scene(seed);
    const Outcome o = run(scene, options);
    const bool gains = o.gain > kMaxGainOfOneStep, gains_on_average = o.mean_gain > kMaxGainOfTenSteps;
    const bool falls_wrong = o.speed && *o.speed > kMaxSpeedError;
    infinite += !o.is_finite;
    gaining += gains;
    gaining_on_average += gains_on_average;
    falling_wrong += falls_wrong;
    free_pieces += o.speed.has_value();
    if (!o.is_finite) {
      fmt::print("seed {:>5}: infinite; {}\n", seed, describe(scene));
    } else if (gains || gains_on_average || falls_wrong) {
      fmt::print("seed {:>5}: gains {:.1f} %, {:.2f} % over ten steps, fall {:.2f} %; {}\n", seed,
                 100 * o.gain, 100 * o.mean_gain, 100 * o.speed.value_or(0), describe(scene));
    }
  }
  fmt::print(
      "\n{}, {} scenes of {} steps: {} became infinite; {} gained more than 10 % in one step, {} more than "
      "1 % over ten; of {} without pins, {} fell with a wrong speed\n",
      options.integrator, options.scenes, options.steps, infinite, gaining, gaining_on_average, free_pieces,
      falling_wrong);
  return infinite == 0 && falling_wrong == 0;
}

}  // namespace weft::engine::lab
