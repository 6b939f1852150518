#pragma once
/// What several commands need.

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "weft/render/camera.h"
#include "weft/scene/scene_reader.h"

namespace weft::app {

/// The file can be written after the simulation, or InputError before it. What is in it stays, and so does a
/// pipe.
void require_writable(const std::filesystem::path& file);

/// The folder is there, or InputError.
void make_folder(const std::filesystem::path& folder);

/// Replaces the file's text; throws InputError if it cannot be written.
void write_text(const std::filesystem::path& file, const std::string& text);

/// Processors of this machine, at least 1.
int num_processors();

/// --set KEY=VALUE, as often as wanted.
void add_set_option(CLI::App& command, Overrides& overrides);

/// "1280x720" as a size; throws InputError for anything else.
PictureSize parse_size(const std::string& text);

}  // namespace weft::app
