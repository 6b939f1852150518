#pragma once
/// `weft bench garments`: garments and a figure as people bring them (tools/wardrobe), with defaults.

#include <filesystem>
#include <string>
#include <vector>

namespace weft::engine::lab {

struct GarmentBenchOptions {
  std::vector<std::string> garments;  // beginnings of scenes' names; empty: all
  std::vector<std::string> motions;   // ends of scenes' names; empty: all
  int frames = 60;                    // of a sixtieth of a second
  int threads = 2;
  double cell = 0.009;        // mean edge of the garments [m]
  std::filesystem::path out;  // where files and scenes go; empty: a temporary folder
};

/// Prints a table in Markdown to standard output. Returns false if cloth crosses anything in any frame, or a
/// scene is refused.
bool bench_garments(const GarmentBenchOptions& options);

}  // namespace weft::engine::lab
