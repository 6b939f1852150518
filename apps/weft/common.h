#pragma once
/// What several commands need.

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "weft/render/camera.h"
#include "weft/scene/scene_reader.h"

namespace weft::engine::app {

/// The folder is there, or InputError.
void make_folder(const std::filesystem::path& folder);

/// A line on standard error; one that is closed or full is no reason to fail.
void say(const std::string& line);

/// Processors of this machine, at least 1.
int num_processors();

/// Threads to use where so many are asked for (0: one per processor): at most four per processor, which is
/// said.
int choose_threads(int asked);

/// --set KEY=VALUE, as often as wanted.
void add_set_option(CLI::App& command, Overrides& overrides);

/// "1280x720" as a size, each from 1 to 16384; throws InputError for anything else.
PictureSize parse_size(const std::string& text);

}  // namespace weft::engine::app
