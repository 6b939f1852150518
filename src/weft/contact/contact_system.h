#pragma once
/// Contact handling: cloth against colliders, itself and other cloth.

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "weft/contact/caught_particles.h"
#include "weft/contact/ccd_fail_safe.h"
#include "weft/contact/cloth_clearance.h"
#include "weft/contact/collider.h"
#include "weft/contact/constraint.h"
#include "weft/contact/contact.h"
#include "weft/contact/contact_memory.h"
#include "weft/contact/contact_point.h"
#include "weft/contact/moving_shape.h"
#include "weft/contact/proximity.h"
#include "weft/contact/shape_clearance.h"
#include "weft/contact/untangle.h"
#include "weft/contact/velocity_projection.h"
#include "weft/core/job_system.h"
#include "weft/core/work_times.h"
#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

/// A cloth as contact handling sees it during a step.
struct ContactCloth {
  const ClothModel* model = nullptr;
  ClothState* state = nullptr;
  const std::vector<char>* is_pinned = nullptr;  // (num_particles)
  double pressure = 0;                           // on its surface, from inside, >= 0 [Pa]
};

/// Contact settings for one pair: a cloth with a collider, another cloth or itself.
struct ContactRule {
  int cloth = 0, other_cloth = -1, collider = -1;  // exactly one of the last two is not -1
  std::optional<double> friction;                  // Coulomb's coefficient; empty: from the bodies [1]
  std::optional<double> static_friction;           // of sticking contacts; empty: likewise [1]
  bool collide = true;                             // false: they do not collide
};

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
///     run_ccd_fail_safe    CCD fail-safe for everything that would still intersect (see ccd_fail_safe.h)
///
/// Cloth keeps half its thickness from colliders, and half of both thicknesses from other cloth. Pinned
/// particles push others, and are not pushed. Work space is kept between steps; results depend on the
/// arguments only.
class ContactSystem {
 public:
  void begin_step(std::span<const ContactCloth> cloths, const std::vector<Collider>& colliders,
                  const ContactStep& step);

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
  /// approaching velocities, and applies friction to sliding ones (see constraint.h).
  void project_contacts(JobSystem& jobs);

  /// CCD fail-safe: stops all penetrations since begin_step. Call it last.
  CcdFailSafeReport run_ccd_fail_safe(JobSystem& jobs);

  /// Particles that are caught between colliders since this step, with each of the colliders that hold them.
  std::span<const Infeasible> newly_caught() const { return newly_caught_; }

  /// All contacts since begin_step, if the step is tracked, each feature pair once: the mean force over the
  /// step from the solve, project_contacts and the impulses of run_ccd_fail_safe. The effect of rigid impact
  /// zones is not included.
  std::vector<ContactPoint> contact_points() const;

  /// Finds the intersections of the present state, with colliders at their present pose, and repairs them
  /// (see untangle.h).
  Intersections find_intersections(std::span<const ContactCloth> cloths,
                                   const std::vector<Collider>& colliders, const ContactStep& now);
  UntangleResult untangle(std::span<const ContactCloth> cloths, const std::vector<Collider>& colliders,
                          const ContactStep& now);
  const Surface& surface() const { return proximity_.surface(); }

  /// The body of a vertex under the common numbering, and its number there; exactly one of cloth and collider
  /// is not -1.
  struct Place {
    int cloth = -1, collider = -1, index = 0;
  };
  Place place_of(int vertex) const;
  Place place_of_triangle(int triangle) const;

  /// The diverged cloth: it moved too far in this step for contact detection; -1 if none did.
  int diverged_cloth() const;

 private:
  struct Body {
    int collider = 0;      // number
    int first_vertex = 0;  // under the common numbering
    int end_vertex = 0;
    int first_triangle = 0;  // likewise
    bool is_closed = false;
    Vec3 min = Vec3::Zero(), max = Vec3::Zero();  // of its vertices, in its own coordinates [m]

    /// Bounds of all its vertices.
    std::pair<Vec3, Vec3> bounds_at(const MeshShape& shape) const;
  };

  /// A box, and the distance from it within which colliders may matter [m].
  struct Region {
    Vec3 min, max;
    double reach;
  };

  /// Lengths of a cloth's edges at rest.
  struct RestEdges {
    double mean = 0, longest = 0;  // [m]
  };

  struct PairSettings {
    double friction = 0;         // [1]
    double static_friction = 0;  // of sticking contacts, if larger [1]
    bool collide = true;
  };

  /// The point of a particle, edge midpoint or triangle that is nearest to a primitive shape.
  struct Nearest {
    double distance;
    Vec3 normal, foot;  // outwards; on the surface
    std::array<double, 4> weight;
  };

  /// A contact force between two features, or on one.
  struct ContactForce {
    std::array<int, 4> vertex;  // as in Constraint
    std::array<double, 4> weight;
    int num_vertices, shape;
    Vec3 normal;
    Vec3 force;  // on the feature with positive weights [N]
  };
  void add_contact_force(const Constraint& c, const Vec3& force);
  ContactPoint describe(const ContactForce& contact) const;

  /// A point on a triangle.
  struct SurfacePoint {
    int triangle;
    Vec3 weights, point;
    double distance_sq;  // from where it is sought [m²]
  };

  /// Two surfaces around a point, which they carry along with their mean motion.
  struct Between {
    Vec3 start, end;                              // the point [m]
    std::array<Vec3, 2> ways;                     // how far the surfaces move in the step [m]
    std::array<SignedDistance, 2> before, after;  // of the point from them, at the start and the end

    /// How much nearer than to fit the surfaces are to the middle at the end [m].
    double missing(double half_thickness) const {
      return half_thickness - 0.5 * (after[0].distance + after[1].distance);
    }
  };

  /// A feature of cloth that touches a collider.
  struct Touch {
    HoldingSide side;
    Vec3 normal, point;  // towards the cloth; at the start [m]
    std::array<int, 3> vertices = {};
    int num_vertices = 0;
  };

  SurfacePoint point_on(int triangle, const Vec3& p, const std::vector<Vec3>& x) const;
  SurfacePoint walk(HoldingSide& side, const Vec3& p, const std::vector<Vec3>& x) const;
  const Body& body_with(int collider) const;
  SignedDistance distance_at_start(HoldingSide& side, const Vec3& p, Vec3& way) const;
  SignedDistance distance_at_end(HoldingSide& side, const Vec3& p) const;
  SignedDistance signed_distance_to(const SurfacePoint& foot, const HoldingSide& side, const Vec3& p,
                                    const std::vector<Vec3>& x) const;
  Between look_between(std::array<HoldingSide, 2>& sides, const Vec3& start) const;
  double cosine_at_start(const Between& between, const std::array<HoldingSide, 2>& sides) const;
  bool is_caught(const Between& between, const std::array<HoldingSide, 2>& sides, int vertex,
                 bool is_pulled) const;
  bool has_long_edge(int vertex, double stretch, bool only_caught) const;
  bool has_long_edge(const Touch& touch, double stretch, bool only_caught) const;
  bool can_hold(const HoldingSide& first, const HoldingSide& second) const;
  bool place_caught(Caught& caught) const;
  bool is_beside(const HoldingSide& side, const Vec3& p, double room) const;
  bool are_present(const std::array<HoldingSide, 2>& sides) const;
  std::optional<Touch> touch_of(const Constraint& c) const;
  void update_caught();
  void find_caught();
  bool find_face(const Vec3& direction, const Touch& touch, HoldingSide& side) const;
  void catch_between(const Touch& first, const Touch& second);
  bool is_between(const Constraint& c) const;
  void add_caught_constraints();
  void store_caught();
  void recall_forces();
  void store_forces();

  using FeatureKey = std::array<int, 5>;  // shape and vertices, -1 beyond the last
  static FeatureKey key_of(const Constraint& c);
  double depth_at_end(const Constraint& c) const;
  bool is_short(const Constraint& c) const;
  bool has_passed(const Constraint& c) const;

  static Nearest nearest_of(const SignedDistance& d, const Vec3& p, const std::array<double, 4>& weight);
  static Nearest nearest_of(const TriangleSignedDistance& d, const Vec3& a, const Vec3& b, const Vec3& c);
  static Nearest find_nearest(const ColliderShape& shape, const Constraint& c, const std::vector<Vec3>& x);

  bool may_survey();
  void expect_ends(const Vec3& acceleration, std::span<const Vec3> pin_targets);
  void survey_expected(const Vec3& acceleration, std::span<const Vec3> pin_targets);
  void survey_solved();
  void survey(double fall);
  void update_lists(JobSystem& jobs);
  Region surveyed_region(double fall) const;
  bool are_shapes_far(double fall) const;
  bool are_bodies_far(double fall) const;
  void place();
  void renumber(const std::vector<Collider>& colliders);
  RepairInput make_repair_input() const;
  std::vector<Vec3> positions_now() const;
  void measure_edges(const Surface& surface, const std::vector<Vec3>& rest);
  Patches build_patches(const Surface& surface, const std::vector<Vec3>& rest) const;
  void place_bodies();
  void expect_motion(const Vec3& acceleration, std::span<const Vec3> pin_targets);
  void generate_pair_constraints(JobSystem& jobs);
  bool make_vertex_triangle(const FeaturePair& pair, Constraint& c) const;
  bool make_vertex_corner(int first, Constraint& c) const;
  bool make_edge_edge(const FeaturePair& pair, Constraint& c) const;
  bool is_behind(std::span<const int> vertices, const Vec3& direction) const;
  bool starts_behind(const Constraint& c) const;
  static void turn_outwards(double& distance, Constraint& c);
  std::optional<double> find_meeting_time(const Constraint& c, double distance, double travel) const;
  static std::array<Vec3, 4> places(const Constraint& c, const std::vector<Vec3>& x);
  std::array<Vec3, 4> places_at(const Constraint& c, double time) const;
  bool finish_crossing(const FeaturePair& pair, Constraint& c) const;
  double gap_of(const FeaturePair& pair, const Constraint& c) const;
  double near_by(double gap, double share) const;
  double share_nearby(const Constraint& c) const;
  double relative_travel(const Constraint& c) const;
  bool finish_pair(double distance, double gap, Constraint& c) const;
  void set_pair_settings();
  void set_non_colliding();
  void set_friction(const PairSettings& settings, Constraint& c) const;
  void store_velocities();
  std::size_t pair_index(const Place& cloth, const Place& other) const;
  const Body& body_of(int vertex) const;
  bool is_on_body(const Constraint& c) const;
  bool is_on_closed_body(int vertex) const;
  void generate_shape_constraints(double share_of_travel, double stretch = 0);
  bool has_plain_shapes() const;
  void generate_constraints_of_shape(int shape, double share_of_travel);
  void find_separations();
  bool is_round(int shape) const;
  double shape_reach(int v, double share_of_travel) const;
  void generate_edge_constraints(int shape, double share_of_travel);
  void generate_triangle_constraints(int shape, double share_of_travel);
  void add_shape_constraint(int cloth, int shape, int num_vertices, const Triangle& vertices,
                            const Nearest& nearest);
  double pinned_depth(const Constraint& c) const;
  void update_plane(const Nearest& at_end, Constraint& c) const;
  double clearance_of(const Constraint& c) const;
  double kept_gap(const Constraint& c) const;
  double pressure_stiffness(const Constraint& c) const;
  bool slides_far(const Constraint& c) const;
  double depth_at_start(const Constraint& c) const;
  bool is_within_ccd_range() const;
  void read_ends();
  bool is_solved(const Constraint& c) const;
  bool mark_unsolved(const Constraint& c);
  bool matches_prediction() const;
  void leave_out_solved();
  void find_candidates(const Vec3& acceleration, std::span<const Vec3> pin_targets, JobSystem& jobs);
  void settle_positions();
  void project(JobSystem& jobs);
  bool has_left_reach() const;
  void undo_slides();
  void mark_touched();
  void store_touched();

  // Constant between renumberings.
  std::vector<std::shared_ptr<const ClothTopology>> numbered_cloths_;
  std::vector<std::shared_ptr<const TriangleMesh>> numbered_meshes_;
  std::vector<int> first_vertex_;  // of each cloth, and the end of the last one
  std::vector<Body> bodies_;
  std::vector<ClosedMesh> closed_meshes_;
  std::vector<char> non_colliding_;    // (bodies, bodies) 1: do not collide; empty: all collide
  std::vector<RestEdges> rest_edges_;  // (cloths)
  double longest_rest_edge_ = 0;       // of all cloths [m]
  bool has_grids_ = false;             // every cloth is a grid
  Proximity proximity_;
  ClothClearance cloth_clearance_;
  ShapeClearance clearance_;
  bool is_clearance_known_ = false;  // clearance_ holds distances from earlier steps

  // The step.
  std::vector<ContactCloth> cloths_;
  std::vector<MovingShape> shapes_;
  ContactStep step_;
  bool has_pressure_ = false;      // some cloth has
  bool is_predicted_ = false;      // the solve includes contacts
  bool is_for_solve_ = false;      // contacts are being predicted
  bool is_near_shape_ = false;     // some vertex may touch a primitive shape
  bool is_placed_ = false;         // motion_ and the members after it are this step's
  bool is_surveyed_ = false;       // only uncertain_ may meet in the motion surveyed last
  bool is_clear_ = false;          // no contact is possible in the motion that project_contacts checked
  int num_without_ = 0;            // number of upcoming steps without a survey
  double pressed_in_ = 0;          // share of the gap that may be missing now [1]
  std::vector<Vec3Array> starts_;  // (cloths) offsets of particles
  SurfaceMotion motion_;
  std::vector<Vec3> expected_;   // (cloth vertices, or empty) end positions predicted for the solve [m]
  std::vector<Vec3> ballistic_;  // (cloth vertices) ballistic prediction [m]
  double thinnest_ = 0, thickest_ = 0;       // half thickness of the thinnest and the thickest cloth [m]
  double longest_edge_ = 0;                  // upper bound for cloth edges [m]
  std::vector<double> inverse_mass_;         // (num_vertices) 0 where prescribed [1/kg]
  std::vector<PairSettings> pair_settings_;  // (cloths, cloths and then colliders)
  std::vector<Vec3> velocity_before_;        // (num_vertices) [m/s]; empty without static friction
  std::vector<Constraint> constraints_;
  std::vector<char> is_solved_;               // (cloths) the solve separated it from all its known contacts
  std::vector<Constraint> solved_for_;        // of the contacts that find_contacts returned
  std::vector<ContactForce> contact_forces_;  // contact forces of this step
  CaughtParticles caught_;
  ContactMemory memory_;
  std::vector<Infeasible> newly_caught_;

  // Work space.
  std::vector<Vec3Array> ends_;       // (cloths) predicted offsets
  AlignedFloats felt_;                // (particles of a cloth)
  std::vector<ClothMotion> motions_;  // (cloths)
  std::vector<ItemPair> uncertain_;   // patch pairs that may meet
  std::vector<std::vector<Constraint>> chunks_;
  std::vector<FeatureKey> known_;  // of solved_for_, sorted
  std::vector<Touch> touches_;
  std::vector<std::pair<int, int>> touched_;  // vertices, and indices into touches_
  std::vector<const TriangleMesh*> meshes_now_;
  std::vector<char> is_touched_;
  std::vector<int> near_;  // indices into constraints_, for project_positions
  VelocityProjection velocity_projection_;
  std::vector<double> shape_distance_;
  std::vector<int> near_shape_;  // vertices
  std::vector<Separation> separations_;
  std::vector<Quad> velocity_, slowed_;
  CcdFailSafe ccd_fail_safe_;
  std::vector<Vec3> origins_;  // (cloths)
  std::vector<Vec3> arrived_;  // positions of the last contact search
};

}  // namespace weft::engine
