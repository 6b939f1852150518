#pragma once
/// What a run tells: figures that were measured, and null for those that were not.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "weft/core/work_times.h"
#include "weft/run/problems.h"

namespace weft::engine {

enum class RunOutcome { done, interrupted, failed };

/// Energies of all cloths at the end of each frame, and what an audit found in it (frames) [J].
struct EnergySeries {
  std::vector<double> kinetic, elastic, bending, gravitational;
  // With RunOptions::audit, else empty: the work of a frame, and what it leaves over (world/energy_audit.h).
  std::vector<double> work_pins, work_shapes, work_wind, work_hands, left_over;
};

struct RunReport {
  std::string scene, integrator, version;
  RunOutcome outcome = RunOutcome::done;
  std::string failure;  // why, if failed
  int particles = 0, triangles = 0, springs = 0;
  int frames = 0;                // simulated
  double seconds_simulated = 0;  // [s]
  int threads = 1;
  double ms_per_frame_median = 0;         // wall time of the simulation alone [ms]
  double ms_per_frame_p95 = 0;            // [ms]
  double cpu_ms_per_frame = 0;            // process CPU time of the simulation alone, mean [ms]
  double untangle_seconds = 0;            // that setting apart what crossed at the start took, wall time [s]
  double max_strain = 0, min_strain = 0;  // extremes over the run, of l/l0 − 1 over structural springs [1]
  double mean_strain = 0;                 // mean over springs and frames [1]
  std::vector<double> max_stretch, min_stretch;  // (frames) principal stretches of membranes; none: empty [1]
  std::vector<double> kinetic_energy;            // (frames) [J]
  std::vector<double> potential_energy;  // (frames) elastic plus gravity, zero at the world's origin [J]
  EnergySeries energy;
  std::vector<double> lowest_y;  // (frames) the first one after the first frame [m]
  // Work of the solver, empty for integrators without it:
  std::vector<int> newton_steps;      // (frames) nonlinear iterations, all cloths [1]
  std::vector<int> cg_iterations;     // (frames) linear iterations inside them [1]
  std::optional<int> guard_events;    // how often the guard stepped in, over the run [1]
  std::vector<int> divisions;         // (frames) parts that steps were made in (World::set_division) [1]
  int retries = 0;                    // parts that were too long and were taken again [1]
  std::map<std::string, int> faults;  // why, by the worst of a step: "stretch", "energy", … [1]
  WorkTimes work;                     // of all steps, where their time went
  // What the last line of contact (contact/last_line.h) had to do, over the run; empty without contact:
  std::optional<int> contact_hits;   // pairs of features left to it [1]
  std::optional<int> contact_zones;  // zones that it moved rigidly [1]
  std::optional<std::vector<std::string>>
      infeasible;  // `frame 12: cloth "sheet" particle 7 and …`, the first
  // What the independent checker (verify/checker.h) found in the frames, the start not counted:
  std::optional<int>
      intersections;            // crossing pairs of triangles in the worst frame; empty without frames [1]
  std::optional<int> crossings_at_end;  // likewise in the last frame [1]
  std::optional<int> passages;  // pairs of features that went through each other (verify/passages.h), over
                                // the run; empty where that was not checked [1]
  std::string first_passage;    // `frame 12: cloth "sheet" particle 7 passes …`; empty: there is none
  std::optional<double>
      penetration_max;     // deepest point of cloth inside a collider; empty without colliders [m]
  std::string state_hash;  // sixteen hexadecimal digits
  std::vector<std::string> warnings;
  std::vector<std::string> notes;    // what was done to meshes as the scene asks: seams that were sewn
  std::vector<RunProblem> problems;  // why the result should not be trusted; empty: nothing was found
};

/// The report as JSON text. What was not measured is null.
std::string to_json(const RunReport& report);

/// Replaces the file whole. Throws InputError if it cannot be written.
void write_report(const std::filesystem::path& file, const RunReport& report);

/// The quantile q in [0, 1] of values (nearest rank); 0 of no values.
double quantile(std::vector<double> values, double q);

}  // namespace weft::engine
