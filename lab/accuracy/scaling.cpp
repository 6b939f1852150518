#include "lab/accuracy/scaling.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lab/accuracy/hung_cloth.h"
#include "lab/accuracy/reference.h"
#include "lab/benchmarks/machine.h"
#include "lab/report/plot.h"
#include "weft/core/simd.h"

namespace weft::engine::lab {
namespace {

constexpr int kStepsBefore = 3;  // warm-up: allocations, and cloth starts to hang

struct Cost {
  double particles = 0;
  std::vector<double> ms;  // median step for each number of threads
  double bytes = 0;        // memory of cloth and integrator; 0: not available
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double median_step_ms(HungCloth& cloth, Integrator& integrator, int steps, int threads) {
  const auto jobs = make_jobs(threads);
  std::vector<double> ms;
  for (int s = 0; s < kStepsBefore + steps; ++s) {
    const double begin = seconds_now();
    integrator.advance(*cloth.model, cloth.environment, kReferenceFrame, *jobs, cloth.state);
    if (s >= kStepsBefore) ms.push_back(1000 * (seconds_now() - begin));
  }
  return median(ms);
}

Cost measure(int size, const ScalingBenchOptions& options) {
  const double before = resident_bytes();
  HungCloth cloth = make_hung_sheet(size, options.model, {});
  const auto integrator = make_newton({.iterations = options.iterations});
  const ClothState start = cloth.state;
  Cost cost{.particles = static_cast<double>(cloth.model->num_particles())};
  for (const int threads : options.threads) {
    cloth.state = start;
    cost.ms.push_back(median_step_ms(cloth, *integrator, options.steps, threads));
  }
  cost.bytes = resident_bytes() - before;
  return cost;
}

/// Positions of a sheet in the frames of a second.
struct Motion {
  int size = 0;                           // particles per side
  std::vector<std::vector<Vec3>> frames;  // (size², row by row) [m]

  /// Position at (u, v) in [0, 1]² of the sheet, bilinear.
  Vec3 at(std::size_t frame, double u, double v) const {
    const double x = u * (size - 1), z = v * (size - 1);
    const int i = std::min(static_cast<int>(x), size - 2), j = std::min(static_cast<int>(z), size - 2);
    const auto particle = [&](int di, int dj) { return frames[frame][(j + dj) * size + i + di]; };
    const double s = x - i, t = z - j;
    return (1 - t) * ((1 - s) * particle(0, 0) + s * particle(1, 0)) +
           t * ((1 - s) * particle(0, 1) + s * particle(1, 1));
  }
};

Motion move(int size, const ScalingBenchOptions& options) {
  HungCloth cloth = make_hung_sheet(size, options.model, {});
  const auto integrator = make_newton({.iterations = options.iterations});
  const auto jobs = make_jobs(options.threads.back());
  Motion motion{size, {}};
  for (int frame = 0; frame < 60; ++frame) {
    integrator->advance(*cloth.model, cloth.environment, kReferenceFrame, *jobs, cloth.state);
    motion.frames.push_back(positions_of(cloth.state));
  }
  return motion;
}

/// RMS over the coarser sheet's particles, mean over the frames [m].
double distance(const Motion& coarse, const Motion& fine) {
  double mean = 0;
  for (std::size_t f = 0; f < coarse.frames.size(); ++f) {
    double sum = 0;
    for (int p = 0; p < coarse.size * coarse.size; ++p) {
      const double u = p % coarse.size / (coarse.size - 1.0), v = p / coarse.size / (coarse.size - 1.0);
      sum += (coarse.frames[f][p] - fine.at(f, u, v)).squaredNorm();
    }
    mean += std::sqrt(sum) / coarse.size / static_cast<double>(coarse.frames.size());
  }
  return mean;
}

void print_motion(const ScalingBenchOptions& options) {
  Motion before;
  for (const int size : options.sizes) {
    Motion motion = move(size, options);
    if (before.size > 0)
      fmt::print("{}² moves {:.4f} m from {}² (RMS, mean over a second)\n", size, distance(before, motion),
                 before.size);
    std::fflush(stdout);
    before = std::move(motion);
  }
}

}  // namespace

void bench_scaling(const ScalingBenchOptions& options) {
  fmt::print(
      "SIMD {}, newton with {} iterations, springs \"{}\"; wall time, median of {} steps of 1/60 s.\n\n",
      to_string(simd_level()), options.iterations, options.model, options.steps);
  fmt::print("| particles |");
  for (const int t : options.threads)
    fmt::print(" ms per step, {} thread{} | ns per particle |", t, t > 1 ? "s" : "");
  fmt::print(" memory MB | bytes per particle |\n|--:|");
  for (std::size_t t = 0; t < options.threads.size(); ++t) fmt::print("--:|--:|");
  fmt::print("--:|--:|\n");
  std::vector<std::vector<PlotPoint>> ms(options.threads.size());  // over particles
  for (const int size : options.sizes) {
    const Cost cost = measure(size, options);
    fmt::print("| {:.0f} |", cost.particles);
    for (std::size_t t = 0; t < ms.size(); ++t) {
      fmt::print(" {:.2f} | {:.0f} |", cost.ms[t], 1e6 * cost.ms[t] / cost.particles);
      ms[t].push_back({cost.particles, cost.ms[t], ""});
    }
    fmt::print(" {:.1f} | {:.0f} |\n", 1e-6 * cost.bytes, cost.bytes / cost.particles);
    std::fflush(stdout);
  }
  fmt::print("\n");
  if (options.sizes.size() < 2) return;
  for (std::size_t t = 0; t < ms.size(); ++t) {
    fmt::print("{} thread{}: time grows like n^{:.2f}\n", options.threads[t],
               options.threads[t] > 1 ? "s" : "", fit_exponent(ms[t]));
  }
  if (options.motion) print_motion(options);
}

}  // namespace weft::engine::lab
