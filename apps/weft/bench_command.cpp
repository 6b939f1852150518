#include <fmt/core.h>

#include <memory>

#include "bench/integrators.h"
#include "commands.h"
#include "weft/core/error.h"
#include "weft/core/simd.h"

namespace weft::app {
namespace {

void limit_simd(const std::string& name) {
  for (const SimdLevel level : {SimdLevel::baseline, SimdLevel::avx2, SimdLevel::avx512}) {
    if (to_string(level) != name) continue;
    if (level > best_simd_level()) throw InputError("this machine has no " + name);
    return limit_simd_level(level);
  }
  throw InputError("--simd must be baseline, avx2 or avx512, not " + name);
}

}  // namespace

void add_bench_command(CLI::App& app, int&) {
  CLI::App* command = app.add_subcommand("bench", "Measure speed");
  command->require_subcommand(1);

  auto options = std::make_shared<bench::IntegratorBenchOptions>();
  auto simd = std::make_shared<std::string>();
  CLI::App* integrators =
      command->add_subcommand("integrators", "Cost of a step for each integrator and size");
  integrators->add_option("--integrators", options->integrators, "Which (default: all)")->delimiter(',');
  integrators->add_option("--sizes", options->sizes, "Particles per side")
      ->delimiter(',')
      ->check(CLI::Range(2, 4096))
      ->capture_default_str();
  integrators->add_option("--threads", options->threads, "Numbers of threads")
      ->delimiter(',')
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  integrators->add_option("--model", options->model, "Springs: basic, simplified, alternating, or mesh")
      ->capture_default_str();
  integrators->add_option("--seconds", options->seconds, "Per measurement")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  integrators->add_option("--simd", *simd,
                          "Use at most baseline, avx2 or avx512 (default: the best there is)");
  integrators->callback([options, simd] {
    if (!simd->empty()) limit_simd(*simd);
    bench::bench_integrators(*options);
  });
}

}  // namespace weft::app
