#pragma once
/// Inputs and results of a live simulation.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "weft/forces/wind.h"
#include "weft/io/animation.h"
#include "weft/model/cloth_model.h"
#include "weft/report.h"
#include "weft/run/problems.h"
#include "weft/scene/pin_edits.h"
#include "weft/world/particle_values.h"

namespace weft::engine {

struct LiveSettings {
  int threads = 1;      // of the simulation, >= 1
  bool playing = true;  // from the start
};

/// A point on a cloth: of a triangle, by the weights of its corners (sum 1).
struct ClothPoint {
  int cloth = 0, triangle = 0;
  Vec3 weights = Vec3::Constant(1.0 / 3);  // [1]

  /// The nearest of the triangle's corners: 0, 1 or 2.
  int nearest_corner() const {
    Eigen::Index corner = 0;
    weights.maxCoeff(&corner);
    return static_cast<int>(corner);
  }
  bool operator==(const ClothPoint&) const = default;
};

/// What is measured for the display, besides the status. The motion is the same with all of it.
struct LiveInstruments {
  std::optional<ParticleValue> color;  // of LiveFrame::meshes
  bool contacts = false;               // LiveFrame::contacts; their tracking costs some percent of a step
  bool yarns = false;                  // LiveFrame::yarns
  std::optional<ClothPoint> probe;     // LiveFrame::probe

  bool tracks_contacts() const { return contacts || probe || color == ParticleValue::contact; }
  bool operator==(const LiveInstruments&) const = default;
};

/// A contact of the last step.
struct ContactForce {
  Vec3 position;  // [m]
  Vec3 force;     // on the cloth [N]
};

/// A triangle's warp and weft.
struct YarnCross {
  Vec3 position;  // of its centre [m]
  Yarns yarns;
  double size = 0;  // of the triangle: square root of its area [m]
};

/// Measurements at a point of a cloth, and at its nearest particle.
struct ProbeReading {
  std::string cloth;
  int triangle = 0, particle = 0;
  Vec3 point = Vec3::Zero();     // [m]
  Vec3 velocity = Vec3::Zero();  // of the particle [m/s]
  std::optional<Yarns> yarns;    // of the triangle; empty: cloth of springs
  double mass = 0;               // of the particle; 0: only its position is known [kg]
  bool is_pinned = false;        // the particle
  std::optional<Vec3> contact;   // force of contacts on the particle in the last step; empty: of a run [N]
};

/// Pins of a cloth.
struct LivePins {
  std::vector<int> vertex_of_particle;  // numbered as ParticleIndices does; -1: none
  PinnedVertices vertices;              // by the pins of the scene that is simulated
  std::vector<int> particles;           // of all pins, soft ones too, ascending
};

/// Edges of a cloth's seams: the triangles at them have different texture coordinates there.
using SeamEdges = std::vector<std::array<int, 2>>;

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

  std::vector<std::string> warnings;  // of integrator and springs that do not fit each other
  std::string failure;                // of the last step, as text; empty: none. A failed step pauses
  std::vector<RunProblem> problems;   // since the start, a reset or a change of the scene
  std::optional<Vec3> held;           // position of the grabbed point [m]

  std::vector<std::string> keys_for_restart;   // that were changed, and need reset() [scene_changes.h]
  std::int64_t first_step = 0, last_step = 0;  // that seek() can show [1]
  double speed = 1;                            // wanted, of real time; below 1: slow motion [1]
};

/// Measurements of a step.
struct LiveSample {
  double time = 0;  // at its end [s]
  WorkTimes work;
  int iterations = 0, linear_iterations = 0, divisions = 1, contacts = 0;  // [1]
  double residual = 0;                                                     // StepReport::residual [1]
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
  std::shared_ptr<const std::vector<SeamEdges>> seams;           // (num_cloths)
  std::shared_ptr<const std::vector<LivePins>> pins;             // (num_cloths)
  std::vector<ContactForce> contacts;                            // see LiveInstruments
  std::vector<YarnCross> yarns;                                  // likewise
  std::optional<ProbeReading> probe;                             // likewise
  std::string no_color;             // why meshes have no values although they were wanted; empty: they have
  std::vector<LiveSample> samples;  // of the steps since the last frame that was taken
};

}  // namespace weft::engine
