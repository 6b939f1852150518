#include "lab/benchmarks/integrators.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>

#include "lab/accuracy/hung_cloth.h"
#include "lab/benchmarks/machine.h"
#include "weft/core/simd.h"
#include "weft/integrators/integrator.h"

namespace weft::engine::lab {
namespace {

/// Bytes per particle that a step moves between memory and registers if every array is accessed once per
/// pass. Empty for solvers with a factorised matrix.
std::optional<double> bytes_per_particle(const std::string& integrator) {
  // Pass 1 reads x, v, m, w and writes u; pass 2 reads u, x, v (and w) and writes x, v.
  const int shared = (8 + 3) + (9 + 6);
  if (integrator == "explicit") return shared * sizeof(float);
  if (integrator == "paper" || integrator == "paper_fixed") return (shared + 1) * sizeof(float);
  return std::nullopt;
}

/// Maximum particles per side for which a step takes less than a few seconds.
int largest_size(const std::string& integrator) {
  if (integrator == "implicit_euler") return 64;
  if (integrator == "desbrun") return 256;
  return 1 << 20;
}

/// Typical step length of the integrator [s].
double usual_step(const std::string& integrator, const ClothModel& model) {
  if (integrator == "desbrun" || integrator == "implicit_euler" || integrator == "newton") return 1.0 / 60;
  if (integrator == "xpbd") return 1.0 / 60 / XpbdSettings{}.substeps;
  return 0.5 * explicit_step_limit(model, {});
}

/// Median over batches of the seconds per step.
double measure_step(Integrator& integrator, HungCloth& sheet, double step, JobSystem& jobs, double seconds) {
  const auto run = [&](int steps) {
    const double begin = seconds_now();
    for (int s = 0; s < steps; ++s)
      integrator.advance(*sheet.model, sheet.environment, step, jobs, sheet.state);
    return (seconds_now() - begin) / steps;
  };
  const double first = std::min(run(1), run(1));
  const int batch = std::clamp(static_cast<int>(seconds / 10 / first), 1, 100000);
  std::vector<double> batches;
  for (const double begin = seconds_now(); batches.empty() || seconds_now() - begin < seconds;) {
    batches.push_back(run(batch));
  }
  std::sort(batches.begin(), batches.end());
  return batches[batches.size() / 2];
}

void bench_one(const std::string& name, int size, int threads, const IntegratorBenchOptions& options,
               double clock) {
  HungCloth sheet = make_hung_sheet(size, options.model, {.damping = 1e-4});
  const double step = usual_step(name, *sheet.model);
  const auto jobs = make_jobs(threads);
  const auto integrator = make_integrator({.integrator = name});
  const double seconds = measure_step(*integrator, sheet, step, *jobs, options.seconds);

  const double particles = sheet.model->num_particles();
  const double springs = static_cast<double>(sheet.model->topology->springs.size());
  fmt::print("{:<15} {:>4}² {:>2} {:>11.2f} {:>10.1f} {:>12.1f}", name, size, threads,
             1e9 * seconds / particles, 1e-6 * particles / seconds, clock * seconds / springs);
  if (const auto bytes = bytes_per_particle(name)) {
    const double bandwidth =
        measure_bandwidth(static_cast<std::size_t>(11 * sizeof(float) * particles), threads);
    const double rate = *bytes * particles / seconds;
    fmt::print(" {:>9.0f} {:>8.1f} {:>9.0f} %", *bytes, 1e-9 * rate, 100 * rate / bandwidth);
  }
  fmt::print("\n");
  std::fflush(stdout);
}

}  // namespace

void bench_integrators(const IntegratorBenchOptions& options) {
  std::vector<std::string> names = options.integrators;
  if (names.empty()) names.assign(integrator_names().begin(), integrator_names().end());
  for (const std::string& name : names) make_integrator({.integrator = name});

  const double clock = measure_clock();
  fmt::print("SIMD {}, clock {:.2f} GHz, springs \"{}\". One step each; median of batches.\n",
             to_string(simd_level()), 1e-9 * clock, options.model);
  fmt::print(
      "Bytes: what a step must move per particle. Share: of the bandwidth measured on a working set of the "
      "same size.\n\n");
  fmt::print("{:<15} {:>5} {:>2} {:>11} {:>10} {:>12} {:>9} {:>8} {:>11}\n", "integrator", "size", "T",
             "ns/particle", "M part./s", "cycles/spring", "bytes", "GB/s", "share");
  for (const std::string& name : names) {
    for (const int size : options.sizes) {
      for (const int threads : options.threads) {
        if (size <= largest_size(name)) bench_one(name, size, threads, options, clock);
      }
    }
  }
}

}  // namespace weft::engine::lab
