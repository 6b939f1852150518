#pragma once
/// `weft bench frontier`: error against time of every integrator at several settings.

#include <filesystem>
#include <string>
#include <vector>

namespace weft::engine::lab {

struct FrontierOptions {
  std::vector<std::string> methods;         // empty: all
  std::vector<int> sizes = {64, 128, 256};  // particles per side of the sheets
  int rings = 40;                           // of the disc; 0: no disc
  int frames = 60;                          // of a sixtieth of a second
  std::filesystem::path cache;              // for references; empty: default_cache_folder()
  std::filesystem::path out;                // for frontier.csv and frontier.svg; empty: no files
};

/// Prints a table per cloth to standard output, then the processor time of newton and xpbd at equal error.
/// Throws InputError for methods that do not exist and folders that cannot be written.
void bench_frontier(const FrontierOptions& options);

}  // namespace weft::engine::lab
