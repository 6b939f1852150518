#pragma once
/// `weft bench random --contact`: contact in random scenes, with defaults.

#include <filesystem>

namespace weft::engine::lab {

struct RandomContactOptions {
  int scenes = 200;
  int first_seed = 1;
  int frames = 60;  // of each scene
  int threads = 2;
  std::filesystem::path out;  // folder for the scenes; empty: a temporary one
};

/// Runs the scenes of the seeds from first_seed on with the independent checker, and prints a row for each that
/// has problems. Returns whether none is refused, fails, or has intersections, passages or penetrations: except
/// those with infeasible pairs, where bodies or pins leave cloth no room.
bool bench_random_contact(const RandomContactOptions& options);

}  // namespace weft::engine::lab
