/// weft-lab: laboratory tests, the study and benchmarks.

#include <filesystem>

#include "apps/common/program.h"
#include "lab/program/commands.h"
#include "weft/core/version.h"

int main(int argc, char** argv) {
  using namespace weft::engine;
  int exit_code = app::kDone;
  // `weft study` starts this program with its own name as argv[0].
  const std::string name = std::filesystem::path(argv[0]).filename().string();
  CLI::App laboratory{"The laboratory of Weft: tests of fabrics, the study, benchmarks", name};
  laboratory.set_version_flag("--version", kVersion);
  laboratory.require_subcommand(1);
  lab::add_study_command(laboratory);
  lab::add_bench_command(laboratory, exit_code);
  return app::run_program(laboratory, argc, argv, exit_code);
}
