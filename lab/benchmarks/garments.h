#pragma once
/// `weft bench garments`: typical user garments on a figure (tools/wardrobe), with default settings.

#include <filesystem>
#include <string>
#include <vector>

namespace weft::engine::lab {

struct GarmentBenchOptions {
  std::vector<std::string> garments;  // prefixes of scene names; empty: all
  std::vector<std::string> motions;   // suffixes of scene names; empty: all
  int frames = 60;                    // of a sixtieth of a second
  int threads = 2;
  double cell = 0.009;        // mean edge of the garments [m]
  std::filesystem::path out;  // for files and scenes; empty: a temporary folder
};

/// Prints a table in Markdown to standard output. Returns false if cloth intersects anything in any frame, or
/// a scene is refused.
bool bench_garments(const GarmentBenchOptions& options);

}  // namespace weft::engine::lab
