#pragma once
/// What several commands need.

#include <filesystem>

namespace weft::app {

/// The file can be written after the simulation, or InputError before it. What is in it stays, and so does a
/// pipe.
void require_writable(const std::filesystem::path& file);

/// The folder is there, or InputError.
void make_folder(const std::filesystem::path& folder);

/// Processors of this machine, at least 1.
int num_processors();

}  // namespace weft::app
