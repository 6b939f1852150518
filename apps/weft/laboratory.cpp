/// `weft study` and `weft bench`: the program weft-lab, beside this one, runs them.

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "apps/common/program.h"
#include "commands.h"

namespace weft::engine::app {

bool is_laboratory_command(int argc, char** argv) {
  return argc > 1 && (argv[1] == std::string_view("study") || argv[1] == std::string_view("bench"));
}

int run_laboratory(char** argv) {
  std::error_code unknown;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", unknown);
  const std::filesystem::path program = self.parent_path() / "weft-lab";
  execv(program.c_str(), argv);
  std::fprintf(stderr, "weft %s needs the program weft-lab, which is not at %s; `make lab` builds it\n",
               argv[1], program.c_str());
  return kBadInput;
}

void add_laboratory_commands(CLI::App& app) {
  app.add_subcommand("study",
                     "A laboratory's standard tests of a fabric, and studies of Weft itself (weft-lab)");
  app.add_subcommand("bench", "Measure speed (weft-lab)");
}

}  // namespace weft::engine::app
