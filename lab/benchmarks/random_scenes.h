#pragma once
/// `weft bench random`: robustness, energy and momentum of an integrator in extreme random scenes.

#include <string>

namespace weft::engine::lab {

struct RandomBenchOptions {
  std::string integrator = "newton";
  int scenes = 1000;
  int first_seed = 1;
  int steps = 60;  // per scene
};

/// Runs the scenes of the seeds from first_seed on and lists, with their seeds, those in which
///   - a value becomes infinite,
///   - the energy gain since the start exceeds a tenth of the energy in motion in a step, or a hundredth on
///     average over ten steps; energy in motion: that of the start plus the work of gravity so far,
///   - cloth without pins falls faster or slower than g t by more than a hundredth.
/// Returns whether all stayed finite and fell correctly. Throws InputError for an unknown integrator.
bool bench_random(const RandomBenchOptions& options);

}  // namespace weft::engine::lab
