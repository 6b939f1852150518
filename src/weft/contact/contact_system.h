#pragma once
/// Holds cloth off colliders, off itself and off other cloth.

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "weft/contact/cloth_clearance.h"
#include "weft/contact/collider.h"
#include "weft/contact/constraint.h"
#include "weft/contact/contact.h"
#include "weft/contact/contact_point.h"
#include "weft/contact/last_line.h"
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

/// What contact sees of a cloth during a step.
struct ContactCloth {
  const ClothModel* model = nullptr;
  ClothState* state = nullptr;
  const std::vector<char>* is_pinned = nullptr;  // (num_particles)
};

/// What is between a cloth and a collider, another cloth or itself.
struct ContactRule {
  int cloth = 0, other_cloth = -1, collider = -1;  // exactly one of the last two is not -1
  std::optional<double> friction;                  // Coulomb's coefficient; empty: as they say themselves [1]
  std::optional<double> static_friction;           // while nothing slides; likewise [1]
  bool collide = true;                             // false: they go through each other
};

struct ContactStep {
  double time = 0;                          // at the end of the step [s]
  double step = 0;                          // its length [s]
  bool tracks = false;                      // whether contact_points() will be asked for
  std::span<const ContactRule> rules = {};  // of two for the same pair the last one counts
  WorkClock* clock = nullptr;               // of the whole step; null: not measured
};

/// Contact of all cloths with all colliders and with each other, step by step:
///
///     begin_step        remembers where everything is, and takes the colliders through the step
///     predict           for integrators that resolve contacts: what will probably meet
///     find_contacts     … as planes in the cloths' way
///     take_solved       the cloths have been moved
///     hold_off          what has come too close all the same is set apart
///     stop_crossings    and whatever would still go through anything is stopped (see last_line.h)
///
/// Cloth keeps half its thickness from colliders, and half of both thicknesses from other cloth. Pinned
/// particles push others, and are not pushed. Keeps its work space between steps; what it does depends on the
/// arguments alone.
class ContactSystem {
 public:
  void begin_step(std::span<const ContactCloth> cloths, const std::vector<Collider>& colliders,
                  const ContactStep& step);

  /// Where inertia and `acceleration` would take each cloth; `pin_targets` are the places of pinned particles
  /// at the end of the step, cloth after cloth in ascending order of particles.
  void predict(const Vec3& acceleration, std::span<const Vec3> pin_targets, JobSystem& jobs);

  /// The contacts of all cloths' particles, which are numbered through the cloths.
  void find_contacts(std::vector<Contact>& contacts);

  /// The cloths' states now are those of the end of the step; `contacts` are those that were found, solved
  /// for, or none.
  void take_solved(std::span<const Contact> contacts);

  /// Sets apart what is too close, takes from velocities what approaches, and slows what slides (see
  /// constraint.h). To be called when every cloth is at its end.
  void hold_off(JobSystem& jobs);

  /// Makes sure that nothing has gone through anything since begin_step. To be called last.
  LastLineReport stop_crossings(JobSystem& jobs);

  /// Everything that has touched since begin_step, if the step is tracked, each pair of features once: what
  /// the solve, hold_off and the impulses of stop_crossings have done to it, as a mean force over the step.
  /// What zones of the last line do is not in it.
  std::vector<ContactPoint> contact_points() const;

  /// What crosses as it is, colliders where they are, now, and sets it apart (see untangle.h).
  Knots find_knots(std::span<const ContactCloth> cloths, const std::vector<Collider>& colliders,
                   const ContactStep& now);
  UntangleResult untangle(std::span<const ContactCloth> cloths, const std::vector<Collider>& colliders,
                          const ContactStep& now);
  const Surface& surface() const { return proximity_.surface(); }

  /// What a vertex of the common numbering belongs to, and its number there; exactly one of cloth and
  /// collider is not -1.
  struct Place {
    int cloth = -1, collider = -1, index = 0;
  };
  Place place_of(int vertex) const;
  Place place_of_triangle(int triangle) const;

  /// The cloth that moved so far in this step that contact could not be looked for, -1 if none did.
  int wild_cloth() const;

 private:
  struct Body {
    int collider = 0;      // number
    int first_vertex = 0;  // of the common numbering
    int end_vertex = 0;
    bool is_closed = false;
    Vec3 min = Vec3::Zero(), max = Vec3::Zero();  // of its vertices, in its own coordinates [m]

    /// Bounds of all its vertices.
    std::pair<Vec3, Vec3> bounds_at(const MeshShape& shape) const;
  };

  /// A box, and how near to it colliders may matter [m].
  struct Region {
    Vec3 min, max;
    double reach;
  };

  struct PairLaw {
    double friction = 0;         // [1]
    double static_friction = 0;  // while nothing slides, if it is more [1]
    bool collide = true;
  };

  /// Where a particle, the middle of an edge or a triangle is nearest to a plain shape.
  struct Nearest {
    double distance;
    Vec3 normal, foot;  // outwards; on the surface
    std::array<double, 4> weight;
  };

  /// A force between two features, or on one.
  struct Touch {
    std::array<int, 4> vertex;  // as in Constraint
    std::array<double, 4> weight;
    int num_vertices, shape;
    Vec3 normal;
    Vec3 force;  // on what has positive weights [N]
  };
  void add_touch(const Constraint& c, const Vec3& force);
  ContactPoint describe(const Touch& touch) const;

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
  Tangle make_tangle() const;
  std::vector<Vec3> positions_now() const;
  Patches build_patches(const Surface& surface, const std::vector<Vec3>& rest) const;
  void place_bodies();
  void expect_motion(const Vec3& acceleration, std::span<const Vec3> pin_targets);
  void collect_pairs(JobSystem& jobs);
  bool make_vertex_triangle(const FeaturePair& pair, Constraint& c) const;
  bool make_vertex_corner(int first, Constraint& c) const;
  bool make_edge_edge(const FeaturePair& pair, Constraint& c) const;
  std::optional<double> find_meeting_time(const Constraint& c, double distance, double travel) const;
  static std::array<Vec3, 4> places(const Constraint& c, const std::vector<Vec3>& x);
  std::array<Vec3, 4> places_at(const Constraint& c, double time) const;
  bool finish_crossing(const FeaturePair& pair, Constraint& c) const;
  double gap_of(const FeaturePair& pair, const Constraint& c) const;
  double near_by(double gap, double share) const;
  double share_nearby(const Constraint& c) const;
  double relative_travel(const Constraint& c) const;
  bool finish_pair(double distance, double gap, Constraint& c) const;
  void set_laws();
  void set_passes();
  void set_friction(const PairLaw& law, Constraint& c) const;
  void remember_velocities();
  std::size_t law_of(const Place& cloth, const Place& other) const;
  const Body& body_of(int vertex) const;
  bool is_on_body(const Constraint& c) const;
  bool is_on_closed_body(int vertex) const;
  void collect_shapes(double share_of_travel, double stretch = 0);
  bool has_plain_shapes() const;
  void collect_shape(int shape, double share_of_travel);
  void find_separations();
  double shape_reach(int v, double share_of_travel) const;
  void collect_edges(int shape, double share_of_travel);
  void collect_triangles(int shape, double share_of_travel);
  void add_shape_constraint(int cloth, int shape, int num_vertices, const Triangle& vertices,
                            const Nearest& nearest);
  void take_plane(const Nearest& at_end, Constraint& c) const;
  double clearance_of(const Constraint& c) const;
  double kept_gap(const Constraint& c) const;
  double depth_at_start(const Constraint& c) const;
  bool is_of_this_world() const;
  void read_ends();
  bool is_solved(const Constraint& c) const;
  bool mark_unsolved(const Constraint& c);
  bool went_as_expected() const;
  void leave_out_solved();
  void find_candidates(const Vec3& acceleration, std::span<const Vec3> pin_targets, JobSystem& jobs);
  void settle_positions();
  void project(JobSystem& jobs);
  bool has_left_reach() const;
  void take_back_slides();
  void mark_touched();
  void store_touched();

  // What does not change from step to step.
  std::vector<std::shared_ptr<const ClothTopology>> numbered_cloths_;
  std::vector<std::shared_ptr<const TriangleMesh>> numbered_meshes_;
  std::vector<int> first_vertex_;  // of each cloth, and the end of the last one
  std::vector<Body> bodies_;
  std::vector<ClosedMesh> closed_meshes_;
  std::vector<char> passes_;      // (things, things) go through each other; empty: none do
  double longest_rest_edge_ = 0;  // of cloth [m]
  bool has_grids_ = false;        // all cloths are grids
  Proximity proximity_;
  ClothClearance cloth_clearance_;
  ShapeClearance clearance_;
  bool is_clearance_known_ = false;  // of clearance_, what was measured in steps before

  // The step.
  std::vector<ContactCloth> cloths_;
  std::vector<MovingShape> shapes_;
  ContactStep step_;
  bool is_predicted_ = false;      // the solve knows of contacts
  bool is_for_solve_ = false;      // contacts are being predicted
  bool is_near_shape_ = false;     // some vertex may touch a plain shape
  bool is_placed_ = false;         // motion_ and what follows it are this step's
  bool is_surveyed_ = false;       // only uncertain_ may meet on the way that was surveyed last
  bool is_clear_ = false;          // nothing can meet anything on the way that hold_off has seen
  int num_without_ = 0;            // steps to come that are not surveyed
  double pressed_in_ = 0;          // share of the distance to be kept that may lack now [1]
  std::vector<Vec3Array> starts_;  // (cloths) offsets of particles
  SurfaceMotion motion_;
  std::vector<Vec3> expected_;  // (cloth vertices) where contacts for the solve were looked for; or empty [m]
  std::vector<Vec3> fallen_;    // where inertia and all of gravity would take it
  double thinnest_ = 0, thickest_ = 0;  // half the thickness, of the thinnest and the thickest cloth [m]
  double longest_edge_ = 0;             // of cloth, at most [m]
  std::vector<double> inverse_mass_;    // (num_vertices) 0 where prescribed [1/kg]
  std::vector<PairLaw> laws_;           // (cloths, cloths and then colliders)
  std::vector<Vec3> velocity_before_;   // (num_vertices) [m/s]; empty without static friction
  std::vector<Constraint> constraints_;
  std::vector<char> is_solved_;  // (cloths) the solve has kept it apart from all that it knew of
  std::vector<int> found_;       // of these, those that find_contacts has given
  std::vector<Touch> touches_;   // in this step

  // Work space.
  std::vector<Vec3Array> ends_;       // (cloths) offsets that are expected
  AlignedFloats felt_;                // (particles of a cloth)
  std::vector<ClothMotion> motions_;  // (cloths)
  std::vector<ItemPair> uncertain_;   // pairs of patches
  std::vector<std::vector<Constraint>> chunks_;
  std::vector<const TriangleMesh*> meshes_now_;
  std::vector<char> is_touched_;
  std::vector<int> near_;  // of constraints_, for project_positions
  VelocityProjection velocity_projection_;
  std::vector<double> shape_distance_;
  std::vector<int> near_shape_;  // vertices
  std::vector<Separation> separations_;
  std::vector<Quad> velocity_, slowed_;
  LastLine last_line_;
  std::vector<Vec3> origins_;  // (cloths)
  std::vector<Vec3> arrived_;  // where contacts were last looked for
};

}  // namespace weft::engine
