#pragma once
/// State of the window as JSON, for tests and benchmarks.

#include <filesystem>

namespace weft::engine::app {

class Viewer;

/// Replaces the file atomically. Throws InputError if it cannot be written.
void write_view_report(const std::filesystem::path& file, const Viewer& viewer);

/// weft-view-1.png, or the first unused number.
std::filesystem::path name_of_next_picture();

}  // namespace weft::engine::app
