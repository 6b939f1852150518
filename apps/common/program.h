#pragma once
/// The frame of a command-line program: exit codes, misspelt commands, errors, closed streams.

#include <CLI/CLI.hpp>

namespace weft::engine::app {

/// Exit codes.
enum ExitCode { kDone = 0, kSimulationFailed = 1, kNotClean = 1, kBadInput = 2, kInterrupted = 130 };

/// Parses the arguments and runs the chosen command. Commands set `exit_code`; an InputError becomes kBadInput.
/// Returns the program's exit code.
int run_program(CLI::App& app, int argc, char** argv, int& exit_code);

}  // namespace weft::engine::app
