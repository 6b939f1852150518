#pragma once
/// What the window shows, as JSON: for tests and benchmarks.

#include <filesystem>

namespace weft::engine::app {

class Viewer;

/// Replaces the file whole. Throws InputError if it cannot be written.
void write_view_report(const std::filesystem::path& file, const Viewer& viewer);

/// weft-view-1.png, or the first number that is not taken.
std::filesystem::path name_of_next_picture();

}  // namespace weft::engine::app
