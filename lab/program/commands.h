#pragma once
/// The commands of weft-lab. Each function adds a command to the command line.

#include <CLI/CLI.hpp>

namespace weft::engine::lab {

void add_study_command(CLI::App& app);       // laboratory tests and the sections of the study
void add_section_commands(CLI::App& study);  // subcommands of `study`
void add_bench_command(CLI::App& app, int& exit_code);

}  // namespace weft::engine::lab
