#pragma once
/// Report of a run: measured metrics, null for those that were not measured.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "weft/core/work_times.h"
#include "weft/run.h"
#include "weft/run/problems.h"

namespace weft::engine {

/// Energies of all cloths at the end of each frame, and the energy audit of the frame (frames) [J].
struct EnergySeries {
  std::vector<double> kinetic, elastic, bending, gravitational;
  // With RunOptions::audit, else empty: work and left_over of a frame (world/energy_audit.h).
  std::vector<double> work_pins, work_shapes, work_wind, work_hands, left_over;
};

struct RunReport {
  std::string scene, integrator, version;
  RunOutcome outcome = RunOutcome::done;
  std::string failure;  // the reason, if failed
  int particles = 0, triangles = 0, springs = 0;
  int frames = 0;                // simulated
  double seconds_simulated = 0;  // [s]
  int threads = 1;
  double ms_per_frame_median = 0;         // wall time of the simulation only [ms]
  double ms_per_frame_p95 = 0;            // [ms]
  double cpu_ms_per_frame = 0;            // process CPU time of the simulation only, mean [ms]
  double untangle_seconds = 0;            // wall time for removing initial intersections [s]
  double max_strain = 0, min_strain = 0;  // extremes over the run, of l/l0 − 1 over structural springs [1]
  double mean_strain = 0;                 // mean over springs and frames [1]
  std::vector<double> max_stretch, min_stretch;  // (frames) principal stretches of membranes; none: empty [1]
  std::vector<double> kinetic_energy;            // (frames) [J]
  std::vector<double> potential_energy;  // (frames) elastic plus gravity, zero at the world's origin [J]
  EnergySeries energy;
  std::vector<double> lowest_y;  // (frames) after each frame [m]
  // Work of the solver, empty for integrators that do not count it:
  std::vector<int> newton_steps;      // (frames) nonlinear iterations, all cloths [1]
  std::vector<int> cg_iterations;     // (frames) linear iterations inside them [1]
  std::optional<int> guard_events;    // interventions of the guard, over the run [1]
  std::vector<int> divisions;         // (frames) parts that steps were divided into (World::set_division) [1]
  int retries = 0;                    // parts that were too long and were repeated [1]
  std::map<std::string, int> faults;  // reasons for that, the worst of a step: "stretch", "energy", … [1]
  WorkTimes work;                     // time of all steps by phase
  int torn = 0;                       // cuts through vertices, where cloth tore [1]
  // Work of the CCD fail-safe (contact/ccd_fail_safe.h) over the run; empty without contact:
  std::optional<int> contact_hits;                     // CCD hits: pairs of features [1]
  std::optional<int> contact_zones;                    // rigid impact zones [1]
  std::optional<std::vector<std::string>> infeasible;  // first ones: `frame 12: cloth "sheet" particle 7 …`
  // Results of the independent checker (verify/checker.h), without the start:
  std::optional<int> intersections;       // crossing triangle pairs in the worst frame; empty: no frames [1]
  std::optional<int> crossings_at_end;    // likewise in the last frame [1]
  std::optional<int> passages;            // feature pairs that passed through each other (verify/passages.h),
                                          // over the run; empty: not checked [1]
  std::string first_passage;              // `frame 12: cloth "sheet" particle 7 passes …`; empty: none
  std::optional<double> penetration_max;  // deepest point of cloth in a collider; empty: no colliders [m]
  std::optional<StepWarning> inside_at_end;  // that point in the last frame, where deeper than 0.1 mm
  std::string state_hash;                    // sixteen hexadecimal digits
  std::vector<std::string> warnings;
  std::vector<std::string> notes;    // changes to meshes that the scene asks for: sewn seams
  std::vector<RunProblem> problems;  // reasons not to trust the result; empty: none found
};

/// The report as JSON text; values that were not measured are null.
std::string to_json(const RunReport& report);

/// Replaces the file atomically. Throws InputError if it cannot be written.
void write_report(const std::filesystem::path& file, const RunReport& report);

/// The quantile q in [0, 1] of values (nearest rank); 0 if there are none.
double quantile(std::vector<double> values, double q);

}  // namespace weft::engine
