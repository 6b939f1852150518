#pragma once
/// The program's commands. Each function adds a command to the command line; the chosen one sets `exit_code`.

#include <CLI/CLI.hpp>

#include "apps/common/program.h"

namespace weft::engine::app {

void add_run_command(CLI::App& app, int& exit_code);
void add_demo_command(CLI::App& app, int& exit_code);
void add_render_command(CLI::App& app, int& exit_code);
void add_view_command(CLI::App& app, int& exit_code);
void add_scenes_command(CLI::App& app, int& exit_code);
void add_fabrics_command(CLI::App& app, int& exit_code);
void add_check_command(CLI::App& app, int& exit_code);
void add_verify_command(CLI::App& app, int& exit_code);
void add_convert_command(CLI::App& app, int& exit_code);

/// `weft study` and `weft bench`, which the program weft-lab runs: run_laboratory() replaces this process by
/// it, and returns only if it is missing. The subcommands here are for the help text only.
bool is_laboratory_command(int argc, char** argv);
int run_laboratory(char** argv);
void add_laboratory_commands(CLI::App& app);

}  // namespace weft::engine::app
