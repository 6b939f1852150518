#include <fmt/core.h>

#include "commands.h"
#include "weft/core/error.h"
#include "weft/core/version.h"

int main(int argc, char** argv) {
  using namespace weft::app;
  int exit_code = kDone;
  CLI::App app{"Weft simulates cloth. Start with: weft scenes, weft run paper/fig6_ball", "weft"};
  app.set_version_flag("--version", weft::kVersion);
  app.require_subcommand(1);
  add_run_command(app, exit_code);
  add_demo_command(app, exit_code);
  add_render_command(app, exit_code);
  add_view_command(app, exit_code);
  add_scenes_command(app, exit_code);
  add_fabrics_command(app, exit_code);
  add_check_command(app, exit_code);
  add_study_command(app, exit_code);
  add_verify_command(app, exit_code);
  add_bench_command(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kBadInput;
  } catch (const weft::InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return kBadInput;
  } catch (const std::exception& error) {
    fmt::print(stderr, "weft: {}\n", error.what());
    return kSimulationFailed;
  }
  return exit_code;
}
