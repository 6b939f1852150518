#pragma once
/// Contact handling: cloth against colliders, itself and other cloth.

#include <span>
#include <vector>

#include "weft/contact/caught_particles.h"
#include "weft/contact/ccd_fail_safe.h"
#include "weft/contact/collider.h"
#include "weft/contact/constraint.h"
#include "weft/contact/contact.h"
#include "weft/contact/contact_forces.h"
#include "weft/contact/contact_memory.h"
#include "weft/contact/contact_point.h"
#include "weft/contact/contact_projection.h"
#include "weft/contact/proximity.h"
#include "weft/contact/shape_constraints.h"
#include "weft/contact/solved_contacts.h"
#include "weft/contact/step_bodies.h"
#include "weft/contact/survey.h"
#include "weft/contact/untangle.h"
#include "weft/core/job_system.h"
#include "weft/core/work_times.h"

namespace weft::engine {

struct ContactStep {
  double time = 0;                          // at the end of the step [s]
  double step = 0;                          // step size [s]
  bool tracks = false;                      // records contacts for contact_points()
  std::span<const ContactRule> rules = {};  // the last one for a pair wins
  WorkClock* clock = nullptr;               // of the whole step; null: not measured
};

/// Contact of all cloths with all colliders and with each other, in this order each step:
///
///     begin_step           stores the start positions and moves the colliders through the step
///     predict              for integrators that resolve contacts: finds the likely contacts
///     find_contacts        … and returns them as half-space constraints
///     read_solution        reads the cloths after the integrator's solve
///     find_violations      finds features that end too near to each other
///     add_missed_contacts  for another solve from the same start: adds the contacts missing from this one
///     project_contacts     contact projection of positions and velocities
///     run_ccd_fail_safe    CCD fail-safe for everything that would still intersect
///
/// The stages read the bodies of the step (step_bodies.h), and hand constraints on (constraint.h):
///
///     survey.h ──▶ proximity.h ──▶ pair_constraints.h ─┬─▶ solve_contacts.h ──▶ the integrator's solve
///     (anything    (candidate      shape_constraints.h │   contact_memory.h              │
///      near?)       pairs)         caught_cloth.h      │                                 ▼
///                                                      └─▶ contact_projection.h ──▶ ccd_fail_safe.h
///
/// Cloth keeps half its thickness from colliders, and half of both thicknesses from other cloth. Pinned
/// particles push others, and are not pushed. Work space is kept between steps; results depend on the
/// arguments only.
class ContactSystem {
 public:
  void begin_step(std::span<const ContactCloth> cloths, const std::vector<Collider>& colliders,
                  const ContactStep& step, JobSystem& jobs);

  /// Predicts contacts from ballistic motion under `acceleration`. `pin_targets` are the positions of pinned
  /// particles at the end of the step, cloth after cloth in ascending order of particles.
  void predict(const Vec3& acceleration, std::span<const Vec3> pin_targets, JobSystem& jobs);

  /// The contacts of all cloths. Particles are numbered through the cloths.
  void find_contacts(std::vector<Contact>& contacts);

  /// Whether predict() found that cloth may meet something.
  bool may_meet() const { return is_predicted_ && !is_clear_; }

  /// Reads the cloths' states at the end of the step. `contacts` are those from find_contacts, solved for,
  /// or none.
  void read_solution(std::span<const Contact> contacts);

  /// Finds the features that are too near at the end positions of the cloths.
  void find_violations(JobSystem& jobs);

  /// Adds contacts that were missing from the solve, because cloth did not move as predicted. Returns whether
  /// there are any; the caller then restores the cloths to the start, solves again, and calls read_solution()
  /// and find_violations().
  bool add_missed_contacts(std::vector<Contact>& contacts, JobSystem& jobs);

  /// Contact projection of what find_violations() found: separates positions that are too close, removes
  /// approaching velocities, and applies friction to sliding ones (see contact_projection.h).
  void project_contacts(JobSystem& jobs);

  /// CCD fail-safe: stops all penetrations since begin_step. Call it last.
  CcdFailSafeReport run_ccd_fail_safe(JobSystem& jobs);

  /// Particles that are caught between colliders since this step, with each of the colliders that hold them.
  std::span<const Infeasible> newly_caught() const { return newly_caught_; }

  /// All contacts since begin_step, if the step is tracked, each feature pair once: the mean force over the
  /// step from the solve, project_contacts and the impulses of run_ccd_fail_safe. The effect of rigid impact
  /// zones is not included.
  std::vector<ContactPoint> contact_points() const { return forces_.points(bodies_); }

  /// Finds the intersections of the present state, with colliders at their present pose, and repairs them
  /// (see untangle.h).
  Intersections find_intersections(std::span<const ContactCloth> cloths,
                                   const std::vector<Collider>& colliders, const ContactStep& now,
                                   JobSystem& jobs);
  UntangleResult untangle(std::span<const ContactCloth> cloths, const std::vector<Collider>& colliders,
                          const ContactStep& now, JobSystem& jobs,
                          const std::function<void(int round)>& on_round);

  const Surface& surface() const { return proximity_.surface(); }
  BodyPlace place_of(int vertex) const { return bodies_.numbering.place_of(vertex); }
  BodyPlace place_of_triangle(int triangle) const {
    return bodies_.numbering.place_of_triangle(surface(), triangle);
  }

  /// The diverged cloth: it moved too far in this step for contact detection; -1 if none did.
  int diverged_cloth() const;

 private:
  /// What constraints are for after the solve.
  Purpose after() const { return is_predicted_ ? Purpose::after_solve : Purpose::projection; }

  void renumber(const std::vector<Collider>& colliders, JobSystem& jobs);
  void place();
  void place_bodies();
  void store_velocities();
  void recall_forces();
  void store_forces();
  void read_ends();
  void read_survey(Survey::Result result);
  void expect_motion(const Vec3& acceleration, std::span<const Vec3> pin_targets);
  void find_candidates(const Vec3& acceleration, JobSystem& jobs);
  void update_lists(JobSystem& jobs);
  void generate_pair_constraints(Purpose purpose, JobSystem& jobs);
  void generate_shape_constraints(Purpose purpose, double share_of_travel, double stretch = 0);
  void lower_between(Purpose purpose, double share_of_travel);
  void generate_constraints_after(JobSystem& jobs);
  void catch_cloth();
  void add_force(const Constraint& c, const Vec3& force);
  bool has_passed(const Constraint& c) const;
  bool matches_prediction() const;
  bool is_within_ccd_range() const;

  // The step.
  StepBodies bodies_;
  ContactStep step_;
  bool is_predicted_ = false;      // the solve includes contacts
  bool is_near_shape_ = false;     // some vertex may touch a primitive shape
  bool is_placed_ = false;         // the members of bodies_ on vertices are this step's
  bool has_few_ = false;           // only the survey's uncertain patches may meet
  bool is_clear_ = false;          // no contact is possible in the motion that project_contacts checked
  std::vector<Vec3Array> starts_;  // (cloths) offsets of particles
  std::vector<Vec3> expected_;     // (cloth vertices, or empty) end positions predicted for the solve [m]
  std::vector<Constraint> constraints_;
  std::vector<Infeasible> newly_caught_;

  // The stages, with what they keep between steps.
  Survey survey_;
  Proximity proximity_;
  ShapeConstraints shape_constraints_;
  bool is_clearance_known_ = false;  // of shapes, from earlier steps
  CaughtParticles caught_;
  ContactMemory memory_;
  SolvedContacts solved_;
  ContactProjection projection_;
  CcdFailSafe ccd_fail_safe_;
  ContactForces forces_;

  // Work space.
  std::vector<Vec3> ballistic_;  // ballistic prediction, as SurfaceMotion::end [m]
  std::vector<std::vector<Constraint>> chunks_;
  std::vector<Separation> separations_;
  std::vector<Vec3> origins_;  // (cloths)
};

}  // namespace weft::engine
