#pragma once
/// The world: cloths, pins, colliders, wind; and step(), which advances them.
///
/// SI units, Y up, right-handed. Steps are deterministic: the same world and the same calls give
/// bit-identical results for any number of threads.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "weft/contact/collider.h"
#include "weft/contact/contact_system.h"
#include "weft/core/work_times.h"
#include "weft/ids.h"
#include "weft/integrators/integrator.h"
#include "weft/model/torn_cloth.h"
#include "weft/report.h"
#include "weft/world/attachment.h"
#include "weft/world/step_check.h"
#include "weft/world/surface_anchor.h"

namespace weft::engine {

struct ClothParts {
  std::string name;                               // for messages and rules; empty: "cloth", "cloth 2", …
  std::shared_ptr<const ClothTopology> topology;  // see build_grid_topology, build_mesh_topology
  ClothMaterial material;
  std::shared_ptr<const ClothElements> elements;  // of a fabric, on the topology's mesh; null: springs only
  std::vector<Vec3> positions;                    // (num_particles) at the start; empty: the rest shape [m]
  Vec3 velocity = Vec3::Zero();                   // of all particles at the start [m/s]
  int layer = 0;                                  // see ClothDesc::layer
  std::shared_ptr<const TearingCloth> tearing;    // of `topology` and `elements`; null: it does not tear
};

/// Particles with prescribed motion: static, along key frames from their positions when pinned, or bound to a
/// collider.
struct Pin {
  std::vector<int> particles;
  RigidMotion motion;
  Vec3 pivot = Vec3::Zero();  // centre of rotation [m]
  int follow = -1;            // index of the collider that they follow, without motion; -1: none
};

/// Result of World::untangle.
struct UntangleReport {
  int rounds = 0;                    // of repair; 0: no intersections [1]
  double farthest = 0;               // largest displacement of a particle [m]
  std::vector<std::string> crossed;  // intersections at the start, identified by name
  std::vector<std::string> left;     // remaining intersections; empty on success
};

/// A cloth or a collider.
using BodyId = std::variant<ClothId, ColliderId>;

/// Points moved by the program: pins or grabs.
struct PointGuide {
  std::vector<Vec3> from, to;  // at the start and the end of the motion; empty: not moved by the program [m]
  double start = 0, end = 0;   // of the motion [s]
  bool is_new = false;         // the motion is that of the next step

  bool is_empty() const { return to.empty(); }
  Vec3 at(std::size_t point, double time) const;
  void begin_step(double time, double dt);
};

class World {
 public:
  World();
  World(World&&) = default;
  World& operator=(World&&) = default;  // not copyable: see clone()

  /// A copy in the same state: it continues bit-identically, and shares no mutable data except the job
  /// system. The observer is not copied.
  World clone() const;

  /// Throws InputError if the description is inconsistent (sizes, numbers out of range, a fabric's elements
  /// with an integrator that supports springs only).
  ClothId add_cloth(const ClothParts& desc);
  /// Throws InputError for invalid shapes. An empty name becomes "collider", "collider 2", ….
  ColliderId add_collider(Collider collider);
  void remove(ClothId cloth);  // with its pins, grabs, and contact settings
  void remove(ColliderId collider);
  bool contains(ClothId cloth) const;
  bool contains(ColliderId collider) const;

  /// Kinematic control of colliders, replaces their key frames. A pose is a displacement from the pose at
  /// add_collider, with rotation about pivot(). `move` sets the pose at the end of the next step: until then
  /// the collider moves evenly, through substeps and parts too, and rotates the shorter way about one axis.
  /// Without another call it then stands still. `place` sets the present pose, and does not sweep cloth on
  /// the way. Throws InputError for invalid poses.
  void move_collider(ColliderId collider, const Pose& at_end);
  void place_collider(ColliderId collider, const Pose& pose);
  /// The same for a mesh's vertices (num_vertices), in mesh coordinates [m]; the pose is unchanged.
  void move_vertices(ColliderId collider, std::vector<Vec3> at_end);
  void place_vertices(ColliderId collider, std::vector<Vec3> positions);
  void set_collider_friction(ColliderId collider, double friction, double static_friction = 0);

  /// Call these between any two steps; the next step uses the new values.
  void set_pins(ClothId cloth,
                std::vector<Pin> pins);  // replaces the cloth's pins; throws InputError for bad indices
  void set_attachments(ClothId cloth,
                       std::vector<Attachment> attachments);  // replaces the cloth's grabs; throws likewise
  void set_attachment_target(ClothId cloth, int attachment, const Vec3& target);
  /// Positions of pinned particles, in the order of the pins' lists, and of the grabs' targets at the end of
  /// the next step: until then they move evenly, through substeps and parts too. Without another call they
  /// stay. Replaces the pins' motions. Throws InputError if the number of points is wrong.
  void move_pins(ClothId cloth, const std::vector<Vec3>& at_end);
  void move_attachments(ClothId cloth, const std::vector<Vec3>& at_end);
  void set_forces(ClothId cloth,
                  const std::vector<Vec3>& forces);  // external (num_particles; empty: none) [N]
  /// Gas inside closed cloth, with this excess over the air outside [Pa]; 0: none, unless it is sealed. A sealed
  /// amount of gas keeps p V: it has this excess at the present volume. Throws InputError for open or twisted
  /// cloth, for an integrator that does not support it, and for sealed gas at or below −kAirPressure or without
  /// a volume.
  void set_pressure(ClothId cloth, double pressure, bool is_sealed);
  double pressure(ClothId cloth) const;  // present excess [Pa]
  double volume(ClothId cloth) const;    // enclosed; throws InputError for open or twisted cloth [m³]
  void set_material(ClothId cloth, const ClothMaterial& material);  // keeps the elements
  void set_material(ClothId cloth, const ClothMaterial& material,
                    std::shared_ptr<const ClothElements> elements);
  /// The same for cloth that tears, from now on. `tearing` is of the cloth as it was added.
  void set_material(ClothId cloth, const ClothMaterial& material,
                    std::shared_ptr<const TearingCloth> tearing);
  /// Teleportation (num_particles): nothing is swept on the way. Pins hold their particles at the new
  /// positions. Throws InputError for wrong numbers of values, and for values that are not finite.
  void set_positions(ClothId cloth, const std::vector<Vec3>& positions);    // keeps velocities [m]
  void set_velocities(ClothId cloth, const std::vector<Vec3>& velocities);  // [m/s]
  void teleport(ClothId cloth, const Pose& pose);  // about the world's origin; rotates velocities too
  void set_gravity(const Vec3& gravity);           // throws InputError if it is not finite [m/s²]
  /// Throws InputError for invalid air or gusts, and for air with an integrator that does not support it.
  void set_wind(const Wind& wind);
  void set_contact(bool enabled);  // with colliders, itself and other cloths
  /// Coulomb's coefficient of two bodies identified by name, in place of those of the bodies. At least one is
  /// a cloth (the same cloth twice: self contact). The static coefficient applies while they do not slide
  /// (slower than 1 cm/s), if it is larger. Throws InputError for unknown names, for names of several bodies,
  /// and below 0.
  void set_friction(const std::string& a, const std::string& b, double friction, double static_friction = 0);
  void set_friction(BodyId a, BodyId b, double friction, double static_friction = 0);
  /// Collision filter: whether two bodies, identified as above, collide.
  void set_collision(const std::string& a, const std::string& b, bool collide);
  void set_collision(BodyId a, BodyId b, bool collide);
  void track_contacts(bool enabled) {
    tracks_contacts_ = enabled;
  }  // for contact_points(); costs some percent
  /// Throws InputError for an unknown name, and for one that supports springs only if a cloth is a fabric.
  void set_integrator(const IntegratorSettings& settings);
  /// Throws InputError if the shortest part is not above 0, and for `enabled` with an integrator that does
  /// not support it.
  void set_division(const StepDivision& division);
  void set_jobs(std::shared_ptr<JobSystem> jobs);  // throws InputError for null

  /// Repairs intersections of cloth with itself, other cloth or colliders, and the order of layers: solids
  /// that cloth is in become thinner and grow back (untangle.cpp). Pinned particles stay. Velocities are kept,
  /// and all positions are unchanged if the repair does not help. Takes seconds for thousands of particles,
  /// otherwise it is a no-op. Calls on_round with the number of each round.
  UntangleReport untangle(const std::function<void(int round)>& on_round = {});

  /// Advances the world by dt > 0 [s]. Where cloth tears, its model has more particles afterwards.
  StepReport step(double dt);

  /// Called in step() at the end of every substep, with the time that the cloths have reached [s]; time() is
  /// the start of the step until the step is done. Also called in steps that fail and are undone, and once more
  /// where cloth has torn.
  void set_observer(std::function<void(double time)> after_substep) { observer_ = std::move(after_substep); }

  double time() const { return time_; }  // [s]

  /// Sets the clock, at which motions by key frames and mesh sequences are evaluated; finite [s].
  void set_time(double time) { time_ = time; }
  int num_cloths() const { return static_cast<int>(cloths_.size()); }
  int num_colliders() const { return static_cast<int>(colliders_.size()); }
  ClothId cloth(int n) const;        // the n-th, in the order of addition
  ColliderId collider(int n) const;  // likewise
  int index(ClothId cloth) const { return static_cast<int>(index_of(cloth)); }  // the n of cloth(n)
  int index(ColliderId collider) const { return static_cast<int>(index_of(collider)); }
  std::uint32_t id() const { return id_; }  // of the world, part of the ids of its bodies
  /// The wanted name; if it is empty, a free one for the kind of body: "cloth", "cloth 2", ….
  std::string free_name(const std::string& wanted, const std::string& kind) const;
  const std::string& name(ClothId cloth) const { return at(cloth).name; }
  const ClothModel& model(ClothId cloth) const { return *at(cloth).model; }
  const ClothState& state(ClothId cloth) const { return at(cloth).state; }
  bool can_tear(ClothId cloth) const { return at(cloth).tearing != nullptr; }
  /// Of the cloth without its tears.
  const ClothTopology& whole_topology(ClothId cloth) const {
    return can_tear(cloth) ? *at(cloth).tearing->whole : *at(cloth).model->topology;
  }
  /// A state from before the last tears, with the particles of now.
  ClothState split(ClothId cloth, const ClothState& state) const;
  const Vec3& attachment_impulse(ClothId cloth) const {
    return at(cloth).attachment_impulse;
  }  // in the last step [N·s]
  const std::vector<Attachment>& attachments(ClothId cloth) const {
    return at(cloth).attachments.attachments();
  }
  const std::vector<Pin>& pins(ClothId cloth) const { return at(cloth).pins; }
  const std::vector<Vec3>& forces(ClothId cloth) const { return at(cloth).forces; }  // external [N]
  const Collider& collider(ColliderId collider) const { return colliders_[index_of(collider)]; }
  const std::vector<Collider>& colliders() const { return colliders_; }
  Pose pose(ColliderId collider) const;  // now

  /// Contacts of the last step with bodies, positions and forces; for a step with substeps, of the last one.
  /// Ordered by bodies; empty without contact, and where contacts are not tracked. Summed over time the
  /// forces balance the cloth's momentum; for jittering cloth those of a single step do not equal its weight.
  std::vector<ContactPoint> contact_points() const;

  /// Reaction force on each pinned particle, in the order of the pins' lists [N]: m a − F, with the mean
  /// acceleration of the last step and all other forces at its end, including contacts where tracked. Zero
  /// before the first step, and after a failed one.
  std::vector<Vec3> pin_forces(ClothId cloth) const;

  /// Whether forces other than gravity may do work on cloth: wind, attachments, or moving pins and colliders.
  bool is_driven() const;

  /// The names of bodies that do not collide (pairs).
  std::vector<std::array<std::string, 2>> non_colliding_pairs() const;

  bool has_contact() const { return contact_; }
  bool tracks_contacts() const { return tracks_contacts_; }
  const std::vector<ContactRule>& rules() const { return rules_; }  // of friction and collision, one per pair
  const Vec3& gravity() const { return gravity_; }
  const Wind& wind() const { return wind_; }
  const IntegratorSettings& integrator() const { return integrator_settings_; }
  const StepDivision& division() const { return division_; }

  /// The motion of a collider.
  struct Guide {
    std::uint32_t number = 0;                             // of its id
    bool moves_by_hand = false, deforms_by_hand = false;  // else by key frames
    std::optional<Pose> pose;                             // at the end of the next step, if set
    std::optional<std::vector<Vec3>> vertices;            // likewise [m]
    RigidMotion motion;                                   // in a snapshot
    std::shared_ptr<const VertexSource> source;           // likewise
  };

  /// Pins, attachments, forces and gas of a cloth.
  struct Held {
    std::vector<Pin> pins;
    std::vector<Vec3> anchors;              // of each pinned particle, in the order of the pins' lists [m]
    std::vector<SurfaceAnchor> on_surface;  // likewise, of pins that follow a collider
    std::vector<Attachment> attachments;
    PointGuide pin_guide, attachment_guide;
    std::vector<Vec3> forces;  // external (num_particles; empty: none) [N]
    Gas gas;
  };

  /// Present pins, attachments, forces and gas, and their replacement. Throws InputError as set_pins() and
  /// set_attachments() do.
  Held held(ClothId cloth) const;
  void hold(ClothId cloth, Held held);

  /// Binds points to the collider as it is now, for pins and attachments that follow it.
  std::vector<SurfaceAnchor> bind(int collider, const std::vector<Vec3>& points) const;

  /// The complete dynamic state; restoring it and stepping again gives bit-identical results.
  struct Snapshot {
    double time = 0;
    std::vector<ClothState> states;
    std::vector<Held> held;     // (cloths)
    std::vector<Guide> guides;  // (colliders)
    double part = 0;            // present length of step parts, 0: undivided [s]
    int calm = 0;               // number of consecutive parts that could have been longer
  };
  Snapshot snapshot() const;
  /// Takes a snapshot of this world, or of one built in the same way. Throws InputError if cloths or
  /// colliders do not match.
  void restore(const Snapshot& snapshot);

  /// Hash of the bits of time, positions and velocities.
  std::uint64_t state_hash() const;

 private:
  struct PinnedParticle {
    int particle, pin;
    Vec3 anchor;               // its position when pinned [m]
    int order = 0;             // in the pins' lists
    SurfaceAnchor on_surface;  // of a pin that follows a collider
  };

  struct Cloth {
    std::uint32_t number = 0;  // of its id
    std::string name;
    std::shared_ptr<const ClothModel> model;
    ClothState state;
    std::vector<Pin> pins;
    std::vector<PinnedParticle> pinned;  // by ascending particle
    Environment environment;             // of a substep
    std::vector<char> is_pinned;         // (num_particles)
    Attachments attachments;
    PointGuide pin_guide, attachment_guide;  // of pins and attachments moved by the program
    int layer = 0;
    std::shared_ptr<const TearingCloth> tearing;  // null: it does not tear
    std::vector<Vec3> forces;                     // external (num_particles; empty: none) [N]
    const ClothModel* held_model = nullptr;       // of a substep: `model`, heavier where attached
    Vec3 attachment_impulse = Vec3::Zero();       // of all attachments in the last step [N·s]
  };

  std::size_t index_of(ClothId id) const;
  std::size_t index_of(ColliderId id) const;
  bool has_name(const std::string& name) const;
  MeshShape& mesh_of(ColliderId id, const std::vector<Vec3>& positions);
  void guide_colliders(double dt);
  void guide_points(double dt);
  void set_acceleration(Cloth& cloth);
  static void set_gas(Cloth& cloth, const Gas& gas);
  static double excess_of(const Cloth& cloth);
  Cloth& at(ClothId id);
  const Cloth& at(ClothId id) const;
  int num_substeps(double dt) const;
  bool divides() const;
  int num_parts_at_most(double dt) const;
  void advance(double time, double dt, StepReport& report);
  StepCheck check_part(const Snapshot& before, double dt, StepReport& report);
  StepCheck try_part(const Snapshot& before, double time, double dt, StepReport& report);
  void accept(const StepReport& part, StepReport& report);
  bool can_tear() const;
  static std::shared_ptr<const ClothModel> model_for(const Cloth& cloth, const std::vector<int>& torn);
  int tear();
  int tear(ClothId id);
  void restore_states(const std::vector<ClothState>& states);
  void put_back(const ClothState& state, std::shared_ptr<const ClothModel> model, Cloth& cloth);
  StepReport fail(const StepCheck& check, StepReport report);
  void begin_contact(double time, double dt);
  void run_ccd_fail_safe(StepReport& report);
  void show_contact_cloths();
  InfeasiblePair describe(const Infeasible& pair, InfeasibleKind kind) const;
  std::vector<std::string> describe(const Intersections& intersections) const;
  Intersections find_intersections();
  World make_stage() const;
  int thin_colliders(const Intersections& crossed, World& stage) const;
  void halt();
  std::string name_of(const BodyPlace& place) const;
  BodyPlace find_place(const std::string& name) const;
  BodyPlace place_of(const BodyId& id) const;
  ContactRule& rule_for(BodyPlace a, BodyPlace b);
  void set_friction_at(BodyPlace a, BodyPlace b, double friction, double static_friction);
  void save(Snapshot& snapshot) const;
  void save_states(std::vector<ClothState>& states) const;
  void save_held(Snapshot& snapshot) const;
  void place_pins(Cloth& cloth, std::vector<Pin> pins);
  void bind_pins(Cloth& cloth) const;
  static void release_followers(int collider, Cloth& cloth);
  bool is_attached(const InfeasiblePair& pair) const;
  void place_followed(double time);
  void set_environment(Cloth& cloth, double time);
  void solve(double dt, StepReport& report);

  std::uint32_t id_ = 0;           // of ids
  std::uint32_t last_number_ = 0;  // given to a cloth or collider
  double time_ = 0;
  bool contact_ = true, tracks_contacts_ = false;
  Vec3 gravity_ = {0, -9.81, 0};  // [m/s²]
  Wind wind_;
  IntegratorSettings integrator_settings_;
  std::unique_ptr<Integrator> integrator_;
  StepDivision division_;
  double part_ = 0;  // present length of step parts, 0: undivided [s]
  int calm_ = 0;     // number of consecutive parts that could have been longer
  std::shared_ptr<JobSystem> jobs_;
  std::vector<Cloth> cloths_;
  std::vector<Collider> colliders_;
  std::vector<Guide> guides_;       // (colliders)
  std::vector<ContactRule> rules_;  // one per pair
  std::function<void(double)> observer_;

  // Work space of step(), kept to avoid allocations.
  WorkClock clock_;
  ContactSystem contact_system_;
  std::vector<ContactCloth> contact_cloths_;
  std::vector<Body> bodies_;
  std::vector<Contact> contacts_;
  std::vector<Vec3> pin_positions_;  // of all cloths
  std::vector<char> is_diverged_;    // (cloths)
  std::vector<Pose> poses_;
  std::vector<std::optional<PlacedCollider>> followed_;  // (colliders) those that pins or attachments follow
  Snapshot before_step_, before_part_;
  std::vector<ClothState> solve_starts_;  // before the solve, if there may be another
  double last_step_ = 0;  // step after before_step_; 0: none, or cloth was changed from outside since [s]
  std::vector<CheckedCloth> checked_;
  std::vector<Vec3> attachment_impulses_;  // (cloths) before the current part
};

}  // namespace weft::engine
