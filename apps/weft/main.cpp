#include "apps/common/program.h"
#include "commands.h"
#include "weft/core/version.h"

int main(int argc, char** argv) {
  using namespace weft::engine::app;
  if (is_laboratory_command(argc, argv)) return run_laboratory(argv);
  int exit_code = kDone;
  CLI::App app{"Weft simulates cloth. Start with: weft scenes, weft run paper/fig6_ball", "weft"};
  app.set_version_flag("--version", weft::engine::kVersion);
  app.require_subcommand(1);
  add_run_command(app, exit_code);
  add_demo_command(app, exit_code);
  add_render_command(app, exit_code);
  add_view_command(app, exit_code);
  add_scenes_command(app, exit_code);
  add_fabrics_command(app, exit_code);
  add_check_command(app, exit_code);
  add_verify_command(app, exit_code);
  add_convert_command(app, exit_code);
  add_laboratory_commands(app);
  return run_program(app, argc, argv, exit_code);
}
