#include <fmt/core.h>

#include <memory>

#include "lab/accuracy/frontier.h"
#include "lab/accuracy/scaling.h"
#include "lab/benchmarks/garments.h"
#include "lab/benchmarks/integrators.h"
#include "lab/benchmarks/kernels.h"
#include "lab/benchmarks/pictures.h"
#include "lab/benchmarks/random_contact.h"
#include "lab/benchmarks/random_scenes.h"
#include "lab/contact/collision.h"
#include "lab/contact/contact_benchmark.h"
#include "lab/program/commands.h"
#include "weft/core/simd.h"
#include "weft/error.h"

namespace weft::engine::lab {
namespace {

void limit_simd(const std::string& name) {
  for (const SimdLevel level : {SimdLevel::baseline, SimdLevel::avx2, SimdLevel::avx512}) {
    if (to_string(level) != name) continue;
    if (level > best_simd_level()) throw InputError("this machine has no " + name);
    return limit_simd_level(level);
  }
  throw InputError("--simd must be baseline, avx2 or avx512, not " + name);
}

template <class Options>
void add_common_options(CLI::App& command, Options& options, std::string& simd) {
  command.add_option("--threads", options.threads, "Numbers of threads")
      ->delimiter(',')
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command.add_option("--seconds", options.seconds, "Per measurement")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command.add_option("--simd", simd, "Use at most baseline, avx2 or avx512 (default: the best available)");
}

void add_integrators(CLI::App& bench) {
  auto options = std::make_shared<IntegratorBenchOptions>();
  auto simd = std::make_shared<std::string>();
  CLI::App* command = bench.add_subcommand("integrators", "Cost of a step for each integrator and size");
  command->add_option("--integrators", options->integrators, "Which (default: all)")->delimiter(',');
  command->add_option("--sizes", options->sizes, "Particles per side")
      ->delimiter(',')
      ->check(CLI::Range(2, 4096))
      ->capture_default_str();
  command->add_option("--model", options->model, "Springs: basic, simplified, alternating, or mesh")
      ->capture_default_str();
  add_common_options(*command, *options, *simd);
  command->callback([options, simd] {
    if (!simd->empty()) limit_simd(*simd);
    bench_integrators(*options);
  });
}

void add_kernels(CLI::App& bench) {
  auto options = std::make_shared<KernelBenchOptions>();
  auto simd = std::make_shared<std::string>();
  CLI::App* command =
      bench.add_subcommand("kernels", "Time of each kernel of newton against the limits of the machine");
  command->add_option("--sizes", options->sizes, "Particles per side")
      ->delimiter(',')
      ->check(CLI::Range(2, 4096))
      ->capture_default_str();
  add_common_options(*command, *options, *simd);
  command->callback([options, simd] {
    if (!simd->empty()) limit_simd(*simd);
    bench_kernels(*options);
  });
}

void add_frontier(CLI::App& bench) {
  auto options = std::make_shared<FrontierOptions>();
  CLI::App* command =
      bench.add_subcommand("frontier", "Error against time for each integrator at several settings");
  command->add_option("--methods", options->methods, "Integrators, or Bullet (default: all)")->delimiter(',');
  command->add_option("--sizes", options->sizes, "Particles per side of the sheets")
      ->delimiter(',')
      ->check(CLI::Range(2, 1024))
      ->capture_default_str();
  command->add_option("--rings", options->rings, "Rings of particles of the disc; 0: no disc")
      ->check(CLI::Range(0, 500))
      ->capture_default_str();
  command->add_option("--frames", options->frames, "Of a sixtieth of a second")
      ->check(CLI::Range(1, 6000))
      ->capture_default_str();
  command->add_option("--cache", options->cache,
                      "Folder where references are kept (default: $XDG_CACHE_HOME/weft or ~/.cache/weft)");
  command->add_option("--out", options->out, "Folder for frontier.csv and frontier.svg");
  command->callback([options] { bench_frontier(*options); });
}

void add_collision(CLI::App& bench, int& exit_code) {
  auto options = std::make_shared<CollisionBenchOptions>();
  auto simd = std::make_shared<std::string>();
  CLI::App* command =
      bench.add_subcommand("collision", "Cost of finding close pairs, and of contact response");
  command->add_option("--sizes", options->sizes, "Triangles")
      ->delimiter(',')
      ->check(CLI::Range(2, 10'000'000))
      ->capture_default_str();
  command->add_option("--cells", options->cells, "Per side of the sheets for contact response")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  add_common_options(*command, *options, *simd);
  command->callback([options, simd, &exit_code] {
    if (!simd->empty()) limit_simd(*simd);
    if (!bench_collision(*options)) exit_code = 1;
  });
}

void add_contact(CLI::App& bench, int& exit_code) {
  auto options = std::make_shared<ContactBenchOptions>();
  CLI::App* command = bench.add_subcommand(
      "contact", "Accuracy and cost of contact: all scenes, checked at every frame, rest, friction, energy");
  command->add_option("--sections", options->sections, "Which (default: all)")
      ->delimiter(',')
      ->check(CLI::IsMember(std::vector<std::string>(kContactSections.begin(), kContactSections.end())));
  command->add_option("--scenes", options->scenes, "Of the section scenes (default: all of contact/)")
      ->delimiter(',');
  command->add_option("--threads", options->threads, "Numbers of threads")
      ->delimiter(',')
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_option("--frames", options->frames, "Of each scene at most (default: all)")
      ->check(CLI::Range(1, 1'000'000));
  command->add_flag("--quick", options->quick, "The beginning of each scene, and coarser sheets");
  command->callback([options, &exit_code] {
    if (!bench_contact(*options)) exit_code = 1;
  });
}

void add_pictures(CLI::App& bench) {
  auto options = std::make_shared<PictureBenchOptions>();
  CLI::App* command = bench.add_subcommand("pictures", "Cost of drawing a picture without a display");
  command->add_option("--triangles", options->triangles, "Of the cloth")
      ->delimiter(',')
      ->check(CLI::Range(2, 10'000'000))
      ->capture_default_str();
  command->add_option("--width", options->size.width, "Pixels")
      ->check(CLI::Range(1, 16384))
      ->capture_default_str();
  command->add_option("--height", options->size.height, "Pixels")
      ->check(CLI::Range(1, 16384))
      ->capture_default_str();
  command->add_option("--repeats", options->repeats, "Pictures per measurement")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->callback([options] { bench_pictures(*options); });
}

void add_scaling(CLI::App& bench) {
  auto options = std::make_shared<ScalingBenchOptions>();
  CLI::App* command = bench.add_subcommand("scaling", "Cost of newton against size, at the same accuracy");
  command->add_option("--sizes", options->sizes, "Particles per side")
      ->delimiter(',')
      ->check(CLI::Range(2, 4096))
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Numbers of threads")
      ->delimiter(',')
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_option("--model", options->model, "Springs: basic, simplified, alternating, or mesh")
      ->capture_default_str();
  command->add_option("--iterations", options->iterations, "Of conjugate gradients")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--steps", options->steps, "Per measurement")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  command->add_flag("--motion", options->motion,
                    "Also report the distance between the motions of consecutive sizes");
  command->callback([options] { bench_scaling(*options); });
}

void add_garments(CLI::App& bench, int& exit_code) {
  auto options = std::make_shared<GarmentBenchOptions>();
  CLI::App* command = bench.add_subcommand(
      "garments", "Typical user garments on a figure, with defaults: intersections, strain, cost");
  command->add_option("--garments", options->garments, "Which, as in dress,coat (default: all)")
      ->delimiter(',');
  command->add_option("--motions", options->motions, "Which of stand, walk, kick, fold, sit (default: all)")
      ->delimiter(',');
  command->add_option("--frames", options->frames, "Of a sixtieth of a second")
      ->check(CLI::Range(1, 6000))
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Of each run")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_option("--cell", options->cell, "Mean edge of the garments, in m")
      ->check(CLI::Range(0.003, 0.05))
      ->capture_default_str();
  command->add_option("--out", options->out, "Folder for meshes and scenes (default: a temporary one)");
  command->callback([options, &exit_code] {
    if (!bench_garments(*options)) exit_code = 1;
  });
}

void add_random(CLI::App& bench, int& exit_code) {
  auto options = std::make_shared<RandomBenchOptions>();
  auto contact = std::make_shared<RandomContactOptions>();
  auto is_contact = std::make_shared<bool>(false);
  auto scenes = std::make_shared<std::optional<int>>();
  auto steps = std::make_shared<std::optional<int>>();
  CLI::App* command = bench.add_subcommand(
      "random", "Energy and momentum in random scenes, from soft and light to stiff and heavy; or contact");
  command->add_flag("--contact", *is_contact,
                    "Contact instead: cloths and moving bodies, every step checked, with defaults");
  command->add_option("--integrator", options->integrator, "Which, without contact")->capture_default_str();
  command->add_option("--scenes", *scenes, "How many (default: 1000; with contact 200)")
      ->check(CLI::Range(1, 1'000'000));
  command->add_option("--first", options->first_seed, "Seed of the first")
      ->check(CLI::Range(0, 1'000'000'000))
      ->capture_default_str();
  command->add_option("--steps", *steps, "Per scene (default: 60)")->check(CLI::Range(1, 1'000'000));
  command->add_option("--threads", contact->threads, "With contact")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_option("--out", contact->out, "Folder for the scenes of --contact (default: a temporary one)");
  command->callback([=, &exit_code] {
    options->scenes = scenes->value_or(options->scenes);
    options->steps = steps->value_or(options->steps);
    contact->scenes = scenes->value_or(contact->scenes);
    contact->frames = steps->value_or(contact->frames);
    contact->first_seed = options->first_seed;
    if (!(*is_contact ? bench_random_contact(*contact) : bench_random(*options))) exit_code = 1;
  });
}

}  // namespace

void add_bench_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("bench", "Measure speed");
  command->require_subcommand(1);
  add_integrators(*command);
  add_kernels(*command);
  add_frontier(*command);
  add_collision(*command, exit_code);
  add_contact(*command, exit_code);
  add_pictures(*command);
  add_garments(*command, exit_code);
  add_random(*command, exit_code);
  add_scaling(*command);
}

}  // namespace weft::engine::lab
