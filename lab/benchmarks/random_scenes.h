#pragma once
/// `weft bench random`: does an integrator stay finite, and keep energy and momentum, in scenes that nobody
/// would make?

#include <string>

namespace weft::engine::lab {

struct RandomBenchOptions {
  std::string integrator = "newton";
  int scenes = 1000;
  int first_seed = 1;
  int steps = 60;  // per scene
};

/// Runs the scenes of the seeds from first_seed on and lists, with their seeds, those in which
///   - something becomes infinite,
///   - the energy of a step is above that of the start by a tenth of what is in motion, or the mean of any
///   ten
///     steps by a hundredth: what is in motion is what the cloth had at the start, and what gravity has
///     given up to then,
///   - cloth without pins falls faster or slower than g t by more than a hundredth.
/// Returns whether all stayed finite and fell as they should. Throws InputError for an unknown integrator.
bool bench_random(const RandomBenchOptions& options);

}  // namespace weft::engine::lab
