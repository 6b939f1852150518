#pragma once
/// Inputs and results of a live simulation.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "weft/forces/wind.h"
#include "weft/io/animation.h"
#include "weft/model/cloth_model.h"
#include "weft/report.h"

namespace weft::engine {

struct LiveSettings {
  int threads = 1;      // of the simulation, >= 1
  bool playing = true;  // from the start
};

/// A point on a cloth: of a triangle, by the weights of its corners (sum 1).
struct ClothPoint {
  int cloth = 0, triangle = 0;
  Vec3 weights = Vec3::Constant(1.0 / 3);  // [1]
};

/// Status of a live simulation.
struct LiveStatus {
  bool playing = false;
  std::int64_t steps = 0;   // since the start or the last reset [1]
  std::int64_t frames = 0;  // of the scene, likewise [1]
  double time = 0;          // simulated [s]
  std::string integrator;
  std::string model;  // of the cloths' springs
  Wind wind;
  int substeps = 0, iterations = 0, divisions = 1;  // of the last step [1]

  double ms_per_step = 0;           // median over the last steps, wall time [ms]
  double ms_per_step_p95 = 0;       // 95th percentile, likewise [ms]
  double steps_per_second = 0;      // over the last second of play, wall time [1/s]
  double simulated_per_second = 0;  // likewise; 1: real time [1]
  bool too_heavy = false;           // for real time: slow motion

  std::vector<std::string> warnings;       // of integrator and springs that do not fit each other
  std::string failure;                     // of the last step, as text; empty: none. A failed step pauses
  std::vector<std::string> step_warnings;  // warnings of the last steps, as text
  std::optional<Vec3> held;                // position of the grabbed point [m]

  std::vector<std::string> keys_for_restart;   // that were changed, and need reset() [scene_changes.h]
  std::int64_t first_step = 0, last_step = 0;  // that seek() can show [1]
  double speed = 1;                            // wanted, of real time; below 1: slow motion [1]
};

/// Measurements of a step.
struct LiveSample {
  double time = 0;  // at its end [s]
  WorkTimes work;
  int iterations = 0, linear_iterations = 0, divisions = 1, contacts = 0;  // [1]
  bool is_measured = false;  // energies and strain, once per frame
  Energies energies;         // at the end of its frame [J]
  double strain = 0;         // largest of all yarns and springs, likewise [1]
};

/// Status and meshes at one time.
struct LiveFrame {
  LiveStatus status;
  std::shared_ptr<const Animation>
      start;  // names, triangles, colours, shapes of the meshes; see LiveSimulation
  AnimationFrame meshes;
  std::vector<std::shared_ptr<const ClothTopology>> topologies;  // (num_cloths)
  std::vector<LiveSample> samples;  // of the steps since the last frame that was taken
};

}  // namespace weft::engine
