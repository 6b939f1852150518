#pragma once
/// The program's commands. Each adds itself to the command line and, when chosen, sets `exit_code`.

#include <CLI/CLI.hpp>

namespace weft::engine::app {

/// Exit codes of the program.
enum ExitCode { kDone = 0, kSimulationFailed = 1, kNotClean = 1, kBadInput = 2, kInterrupted = 130 };

void add_run_command(CLI::App& app, int& exit_code);
void add_demo_command(CLI::App& app, int& exit_code);
void add_render_command(CLI::App& app, int& exit_code);
void add_view_command(CLI::App& app, int& exit_code);
void add_scenes_command(CLI::App& app, int& exit_code);
void add_fabrics_command(CLI::App& app, int& exit_code);
void add_check_command(CLI::App& app, int& exit_code);
void add_study_command(CLI::App& app, int& exit_code);
void add_chapter_commands(CLI::App& studies);  // of `weft study`
void add_verify_command(CLI::App& app, int& exit_code);
void add_bench_command(CLI::App& app, int& exit_code);

}  // namespace weft::engine::app
