#include "lab/benchmarks/kernels.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>

#include "lab/accuracy/hung_cloth.h"
#include "lab/benchmarks/machine.h"
#include "weft/core/simd.h"
#include "weft/forces/potential.h"
#include "weft/integrators/scalar_preconditioner.h"
#include "weft/solvers/conjugate_gradients.h"

namespace weft::engine::lab {
namespace {

/// Counts per particle. Bytes: every array is read or written once. Loads: floats, with repeated loads for
/// neighbours. Operations: additions, multiplications, comparisons. Slow: square roots and divisions.
struct Counts {
  double bytes = 0, loads = 0, operations = 0, slow = 0;
};

constexpr double kFloat = sizeof(float);
constexpr double kSprings = 5;  // per particle, `simplified`

/// x = y + e; each spring's ends, then its Hessian (4) and slope; forces gather 5 slopes and positions at
/// both sides.
constexpr Counts kLinearise = {
    .bytes = kFloat * ((6 + 3) + (3 + 5 * kSprings) + (3 + 1) + (5 + 3 + 3 + 1 + 3)),
    .loads = 6 + kSprings * 6 + 4 + 3 * (2 + 4 * kSprings),
    .operations = 3 + kSprings * 31 + 8 + 3 * (1 + 6 * kSprings),
    .slow = 3 * kSprings};

/// The same without Hessian and forces.
constexpr Counts kEnergy = {.bytes = kFloat * ((6 + 3) + 3 + 4),
                            .loads = 6 + kSprings * 6 + 4,
                            .operations = 3 + kSprings * 14 + 8,
                            .slow = kSprings};

/// t d + w (w·d) of ten springs, each Hessian read from both its ends.
constexpr Counts kMultiply = {.bytes = kFloat * (3 + 1 + 4 * kSprings + 3),
                              .loads = 4 + 2 * kSprings * (4 + 3),
                              .operations = 3 + 2 * kSprings * (3 + 5 + 12) + 6};

/// Finest grid: smoothing from zero, residual, restriction, prolongation, smoothing. The coarser grids, with
/// two more couplings, add a third of that.
constexpr Counts kFinest = {.bytes = kFloat * (7 + 10.75 + 6.75 + 14),
                            .loads = 4 + (7 + 3 * 8) + 9 + 6 + (8 + 3 * 8),
                            .operations = 3 + 3 * 14 + 17 + 9 + 3 * 16 + 6};
constexpr Counts kVCycle = {.bytes = kFinest.bytes + (kFinest.bytes + 2 * kFloat) / 3,
                            .loads = kFinest.loads + (kFinest.loads + 16) / 3,
                            .operations = kFinest.operations + (kFinest.operations + 24) / 3};

/// p = z + β p, x += α p, r −= α q.
constexpr Counts kVectors = {.bytes = kFloat * 3 * (3 + 6), .loads = 3 * (2 + 4), .operations = 3 * (2 + 4)};

/// Median of batches, seconds per call.
template <class Run>
double time_of(const Run& run, double seconds) {
  const auto batch_of = [&](int count) {
    const double begin = seconds_now();
    for (int i = 0; i < count; ++i) run();
    return (seconds_now() - begin) / count;
  };
  const double first = std::min(batch_of(1), batch_of(1));
  const int count = std::clamp(static_cast<int>(seconds / 20 / first), 1, 100000);
  std::vector<double> batches;
  for (const double begin = seconds_now(); batches.empty() || seconds_now() - begin < seconds;)
    batches.push_back(batch_of(count));
  const auto middle = batches.begin() + static_cast<std::ptrdiff_t>(batches.size() / 2);
  std::nth_element(batches.begin(), middle, batches.end());
  return *middle;
}

struct Machine {
  double loads = 0, operations = 0, slow = 0;  // of one thread, floats per second
};

class Kernels {
 public:
  Kernels(int size, int threads, const KernelBenchOptions& options, const Machine& machine)
      : options_(options),
        machine_(machine),
        threads_(threads),
        size_(size),
        jobs_(make_jobs(threads)),
        sheet_(make_hung_sheet(size, "simplified", {})) {
    const ClothModel& model = *sheet_.model;
    potential_.fit(model, 60);
    const PaddedRows& rows = potential_.rows();
    const std::vector<int> pinned = sheet_.environment.pins.particle;
    for (int i = 0; i < model.num_particles(); ++i) {
      potential_.weight[rows.index(i)] = static_cast<float>(3600 * model.mass[i]);
      potential_.target.set(rows.index(i), sheet_.state.x.get(i));
    }
    for (Vec3Array* field : {&offset_, &force_, &direction_, &product_}) *field = Vec3Array(rows.size());
    for (int i = 0; i < model.num_particles(); ++i)
      offset_.set(rows.index(i), 1e-3 * Vec3(i % 7, i % 5, i % 3));
    preconditioner_.set_springs(model, rows, 1.0 / 60, potential_.weight, pinned);
    preconditioner_.set_diagonal(potential_.weight, *jobs_);
    potential_.linearise(offset_, *jobs_, force_);
  }

  void measure() {
    row("energy, force, Hessian", kLinearise, [&] { potential_.linearise(offset_, *jobs_, force_); });
    row("energy only", kEnergy, [&] { potential_.energy(offset_, *jobs_); });
    row("product with the Hessian", kMultiply, [&] { potential_.multiply(force_, *jobs_, product_); });
    row("V-cycle", kVCycle, [&] { preconditioner_.apply(force_, *jobs_, product_); });
    // Ten iterations of a solver with free matrix and preconditioner.
    const auto nothing = [](const Vec3Array&, Vec3Array&) { return 1.0; };
    row(
        "vectors of one CG iteration", kVectors,
        [&] { gradients_.solve(nothing, nothing, force_, {.iterations = 10}, *jobs_, direction_); }, 10);
    fmt::print("| {}² | {} | hierarchy's values, recomputed | {:.2f} | – | – | – | – |\n", size_, threads_,
               per_particle(time_of([&] { preconditioner_.set_diagonal(potential_.weight, *jobs_); },
                                    options_.seconds)));
  }

 private:
  double per_particle(double seconds) const { return 1e9 * seconds / sheet_.model->num_particles(); }

  template <class Run>
  void row(const std::string& name, const Counts& counts, const Run& run, int repeats = 1) {
    const double ns = per_particle(time_of(run, options_.seconds)) / repeats;
    const auto working_set = static_cast<std::size_t>(counts.bytes * sheet_.model->num_particles());
    const double bytes = 1e9 * counts.bytes / measure_bandwidth(working_set, threads_);
    const double loads = 1e9 * counts.loads / (machine_.loads * threads_);
    const double operations =
        1e9 * (counts.operations / machine_.operations + counts.slow / machine_.slow) / threads_;
    fmt::print("| {}² | {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.1f} |\n", size_, threads_, name, ns,
               bytes, loads, operations, ns / std::max({bytes, loads, operations}));
    std::fflush(stdout);
  }

  KernelBenchOptions options_;
  Machine machine_;
  int threads_, size_;
  std::unique_ptr<JobSystem> jobs_;
  HungCloth sheet_;
  IncrementalPotential potential_;
  ScalarPreconditioner preconditioner_;
  ConjugateGradients gradients_;
  Vec3Array offset_, force_, direction_, product_;
};

}  // namespace

void bench_kernels(const KernelBenchOptions& options) {
  const Machine machine{measure_loads(), measure_arithmetic(), measure_roots_and_divisions()};
  fmt::print(
      "SIMD {}; thousand million floats per second and thread: {:.0f} loads, {:.0f} additions and "
      "multiplications, "
      "{:.1f} square roots and divisions\n\n",
      to_string(simd_level()), 1e-9 * machine.loads, 1e-9 * machine.operations, 1e-9 * machine.slow);
  fmt::print(
      "| sheet | threads | kernel | ns per particle | bound by bytes | by loads | by arithmetic | times the "
      "highest bound |\n|--:|--:|---|--:|--:|--:|--:|--:|\n");
  for (const int size : options.sizes) {
    for (const int threads : options.threads) Kernels(size, threads, options, machine).measure();
  }
}

}  // namespace weft::engine::lab
