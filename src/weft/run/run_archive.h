#pragma once
/// Private to run/: members of a run's values for core/archive.h. Any change of a list is a new version of the
/// format of checkpoints (checkpoint.h).

#include "weft/core/archive.h"
#include "weft/run/problems.h"
#include "weft/run/report.h"
#include "weft/verify/passages.h"

namespace weft::engine {

template <class Archive>
void describe(Archive& archive, StepWarning& w) {
  members(archive, w.code, w.cloth, w.particle, w.value, w.fault, w.collider);
}
template <class Archive>
void describe(Archive& archive, InfeasiblePair& p) {
  members(archive, p.cloth, p.particle, p.other_cloth, p.other_particle, p.collider, p.kind);
}
template <class Archive>
void describe(Archive& archive, WorkTimes& w) {
  members(archive, w.total, w.lists, w.narrow_phase, w.rows, w.set_up, w.product, w.v_cycle, w.projection,
          w.ccd, w.retries, w.pairs_listed, w.looks, w.pairs_tested, w.active, w.list_renewals);
}
template <class Archive>
void describe(Archive& archive, EnergySeries& e) {
  members(archive, e.kinetic, e.elastic, e.bending, e.gravitational, e.work_pins, e.work_shapes, e.work_wind,
          e.work_hands, e.left_over);
}
template <class Archive>
void describe(Archive& archive, RunProblem& p) {
  members(archive, p.code, p.frames, p.value, p.message);
}
template <class Archive>
void describe(Archive& archive, RunReport& r) {
  members(archive, r.scene, r.integrator, r.version, r.outcome, r.failure, r.particles, r.triangles,
          r.springs, r.frames, r.seconds_simulated, r.threads, r.ms_per_frame_median, r.ms_per_frame_p95,
          r.cpu_ms_per_frame, r.untangle_seconds, r.max_strain, r.min_strain, r.mean_strain, r.max_stretch,
          r.min_stretch, r.kinetic_energy, r.potential_energy, r.energy, r.lowest_y, r.newton_steps,
          r.cg_iterations, r.guard_events, r.divisions, r.torn, r.retries, r.faults, r.work, r.contact_hits,
          r.contact_zones, r.infeasible, r.intersections, r.crossings_at_end, r.passages, r.first_passage,
          r.penetration_max, r.inside_at_end, r.state_hash, r.warnings, r.notes, r.problems);
}
template <class Archive>
void describe(Archive& archive, ProblemFinder::Record& r) {
  members(archive, r.worst, r.frames, r.consecutive, r.is_reported);
}
template <class Archive>
void describe(Archive& archive, ProblemFinder::Found& f) {
  members(archive, f.strained, f.flat, f.open, f.others, f.infeasible, f.inside, f.num_frames, f.crossings,
          f.passages, f.energy, f.max_energy, f.min_energy, f.max_kinetic);
}

namespace verify {

template <class Archive>
void describe(Archive& archive, FeaturePair& p) {
  members(archive, p.kind, p.surface, p.other, p.feature, p.opposite);
}
template <class Archive>
void describe(Archive& archive, PassageWatch::Open& o) {
  members(archive, o.is_through, o.is_known);
}
template <class Archive>
void describe(Archive& archive, PassageWatch::Pending& p) {
  members(archive, p.open, p.num_left_out);
}

}  // namespace verify
}  // namespace weft::engine
