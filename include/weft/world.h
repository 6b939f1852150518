#pragma once
/// World: cloths, colliders, pins and wind, stepped through time. Everything is in SI units.
///
/// Threads: calls on different worlds may run concurrently. On one world, const calls may run concurrently,
/// but never with a non-const call.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "weft/cloth.h"
#include "weft/collider.h"
#include "weft/error.h"
#include "weft/export.h"
#include "weft/ids.h"
#include "weft/jobs.h"
#include "weft/report.h"
#include "weft/solver.h"
#include "weft/vec.h"
#include "weft/wind.h"

namespace weft {

/// A cloth or a collider.
using BodyId = std::variant<ClothId, ColliderId>;

/// Kind of force on particles.
enum class ForceKind {
  gravity,
  elastic,   // of springs, membranes, strain limits, bending, and gas in closed cloth
  damping,   // internal damping of the cloth
  wind,      // the wind's drag, and aerodynamic drag and lift
  external,  // set by set_forces()
  contact,   // of the last step, each on the nearest particle; needs ContactSettings::tracks_points
};

/// Positions of particles as the engine stores them: floats relative to an origin, which follows the cloth.
/// Component c of particle i is data[c · stride + i], and its position origin + that. The memory shows the
/// newest state after every call on the world; after remove() and the world's end it keeps the last one. Where cloth
/// tears, it has other memory from then on.
struct ClothOffsets {
  std::shared_ptr<const float> data = {};  // (3 x stride) [m]
  std::size_t num_particles = 0;
  std::size_t stride = 0;  // from a particle's x to its y, and from y to z [floats]
  Vec3 origin = {};        // now [m]
};

/// State of a world at a time; see World::snapshot().
class WEFT_API Snapshot {
 public:
  Snapshot();
  ~Snapshot();
  Snapshot(Snapshot&&) noexcept;
  Snapshot& operator=(Snapshot&&) noexcept;
  Snapshot(const Snapshot&);
  Snapshot& operator=(const Snapshot&);

 private:
  friend class World;
  struct Data;
  std::unique_ptr<Data> data_;
};

/// Every call throws InputError for ids that are empty, of another world or of a removed body, and for
/// invalid numbers; the world is then unchanged.
class WEFT_API World {
 public:
  World();
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;  // not copyable: see clone()

  /// A world in the same state. It continues with the same bits and shares no mutable state but the job
  /// system.
  World clone() const;

  // Cloths and colliders.

  /// Throws InputError for an invalid cloth mesh, and for a fabric with an integrator that supports springs
  /// only.
  ClothId add_cloth(const ClothDesc& desc);
  ColliderId add_collider(const ColliderDesc& desc);
  void remove(ClothId cloth);  // with its pins, forces, friction and collision settings
  void remove(ColliderId collider);
  bool contains(ClothId cloth) const;
  bool contains(ColliderId collider) const;
  int num_cloths() const;
  int num_colliders() const;
  ClothId cloth(int n) const;        // the n-th present cloth, in the order of addition
  ColliderId collider(int n) const;  // likewise
  std::string name(ClothId cloth) const;
  std::string name(ColliderId collider) const;
  const ClothNotes& notes(ClothId cloth) const;
  const std::vector<std::string>& warnings(ColliderId collider) const;  // flaws of its mesh, as sentences

  /// Separates cloth that intersects itself, other cloth or colliders, and puts layers in order. Pinned
  /// particles stay, velocities are kept, and all positions stay if that fails. Takes seconds for thousands
  /// of particles; otherwise a no-op. Returns the remaining intersections, as sentences.
  std::vector<std::string> untangle();

  // Motion controlled by the program, between two steps.

  /// Sets a collider's pose at the end of the next step, from its own coordinates to the world. During the
  /// step its pivot moves evenly, and it turns evenly about one axis, the shorter way: split more than half a
  /// turn over several steps. Without a further call it stands still. Replaces its key frames.
  void move_collider(ColliderId collider, const Pose& at_end);

  /// Places a collider immediately, without a swept motion.
  void place_collider(ColliderId collider, const Pose& pose);

  /// The same for the vertices of a mesh collider, all input vertices, in its own coordinates [m]. The pose
  /// stays.
  void move_vertices(ColliderId collider, const std::vector<Vec3>& at_end);
  void place_vertices(ColliderId collider, const std::vector<Vec3>& positions);

  void set_pins(ClothId cloth, const std::vector<Pin>& pins);  // replaces the previous pins
  void add_pin(ClothId cloth, const Pin& pin);                 // the others keep their motions and targets
  void unpin(ClothId cloth, const std::vector<int>& particles);

  /// Pinned particles, in the order of the pins' lists.
  std::vector<int> pinned_particles(ClothId cloth) const;

  /// Sets pinned particles' positions at the end of the next step, one for each, in the order of the pins'
  /// lists; during the step they move evenly. Without a further call they stay. Replaces the pins' key
  /// frames.
  void move_pins(ClothId cloth, const std::vector<Vec3>& at_end);

  /// The same for some pinned particles [m]. The others keep targets given since the last step, or stay.
  void move_pins(ClothId cloth, const std::vector<int>& particles, const std::vector<Vec3>& at_end);

  /// External forces, one for each particle; constant until the next call. Empty: none [N].
  void set_forces(ClothId cloth, const std::vector<Vec3>& forces);

  /// Gas inside closed cloth, in excess of the air outside; 0: none, unless it is sealed [Pa]. The excess is kept,
  /// or a sealed amount of gas keeps the product of absolute pressure and volume (Boyle), from `pressure` at the
  /// present volume. Throws InputError for cloth with a border or with edges whose triangles face opposite ways, for
  /// integrators besides newton, implicit_euler and xpbd, for a number that is not finite, and for sealed gas without a
  /// volume, or at an excess of -101325 Pa or less.
  void set_pressure(ClothId cloth, double pressure, bool sealed = false);
  double pressure(ClothId cloth) const;  // present excess [Pa]
  double volume(ClothId cloth) const;    // inside closed cloth; throws InputError for cloth that is not [m³]

  // State from outside: a jump, without a swept motion. Pins then hold at the new positions.

  void set_positions(ClothId cloth, const std::vector<Vec3>& positions);    // velocities stay [m]
  void set_velocities(ClothId cloth, const std::vector<Vec3>& velocities);  // [m/s]

  /// Moves a whole cloth by p ↦ rotation p + translation, in the world's coordinates. Velocities rotate with
  /// it, or become zero.
  void teleport(ClothId cloth, const Pose& displacement, bool keeps_velocity = true);

  // Settings; the next step uses them.

  void set_fabric(ClothId cloth, const std::variant<Fabric, Springs>& fabric);  // the rest shape stays
  void stiffen(ClothId cloth, const std::vector<int>& particles,
               double factor);  // springs with both ends among `particles`
  void set_friction(ColliderId collider, double friction, double static_friction = 0);
  void set_friction(BodyId a, BodyId b, double friction, double static_friction = 0);  // of this pair only
  void set_collision(BodyId a, BodyId b, bool collide);  // self-collision: the same id twice
  void set_gravity(const Vec3& gravity);                 // [m/s²]
  void set_wind(const Wind& wind);
  void set_integrator(const IntegratorSettings& settings);
  void set_division(const StepDivision& division);
  void set_contact(const ContactSettings& settings);
  void set_jobs(std::shared_ptr<JobSystem> jobs);  // threads; they do not change the result
  Vec3 gravity() const;                            // [m/s²]
  Wind wind() const;
  IntegratorSettings integrator() const;
  StepDivision division() const;
  ContactSettings contact() const;

  /// A body as it was added, with its name and its present fabric and friction.
  const ClothDesc& description(ClothId cloth) const;
  const ColliderDesc& description(ColliderId collider) const;

  // Time.

  /// Advances the world by dt > 0 [s].
  StepReport step(double dt);
  double time() const;  // [s]

  // Cloth data. Arrays are by particle. Pointers take three numbers per particle, `stride` bytes apart.

  int num_particles(ClothId cloth) const;
  const std::vector<Triangle>& triangles(ClothId cloth) const;  // of particles
  std::vector<CornerUv> uv(ClothId cloth) const;                // (num_triangles), or empty
  std::vector<Vec3> rest_positions(ClothId cloth) const;        // of the shape, in its own coordinates [m]
  std::vector<Vec3> positions(ClothId cloth) const;             // [m]
  std::vector<Vec3> velocities(ClothId cloth) const;            // [m/s]
  std::vector<double> masses(ClothId cloth) const;              // [kg]
  void copy_positions(ClothId cloth, float* out, std::size_t stride = 3 * sizeof(float)) const;
  void copy_positions(ClothId cloth, double* out, std::size_t stride = 3 * sizeof(double)) const;
  void copy_velocities(ClothId cloth, float* out, std::size_t stride = 3 * sizeof(float)) const;
  void copy_velocities(ClothId cloth, double* out, std::size_t stride = 3 * sizeof(double)) const;
  void copy_normals(ClothId cloth, float* out, std::size_t stride = 3 * sizeof(float)) const;  // unit length
  void copy_normals(ClothId cloth, double* out, std::size_t stride = 3 * sizeof(double)) const;

  /// Positions of the vertices given to add_cloth, in their order: merged ones coincide, dropped ones stay at
  /// their initial positions [m].
  std::vector<Vec3> vertex_positions(ClothId cloth) const;

  /// Positions in the engine's memory, without a copy.
  ClothOffsets offsets(ClothId cloth) const;

  // Measurements, in double precision, computed on demand.

  std::vector<Vec3> forces(ClothId cloth, ForceKind kind) const;  // on each particle [N]
  std::vector<Vec3> forces(ClothId cloth) const;                  // of all kinds [N]

  /// Reaction force of each pin, in the order of the pins' lists: the particle's mass times its acceleration
  /// in the last step, less all other forces at its end. Zero before the first step. Contacts are included
  /// only if they are tracked [N].
  std::vector<Vec3> pin_forces(ClothId cloth) const;

  std::vector<double> spring_strains(ClothId cloth) const;  // length over rest length − 1, per spring [1]
  std::vector<TriangleStrain> triangle_strains(ClothId cloth) const;
  std::vector<ContactPoint> contact_points() const;  // of the last step, if tracked
  Energies energies() const;
  Vec3 momentum(ClothId cloth) const;        // [kg·m/s]
  Vec3 center_of_mass(ClothId cloth) const;  // [m]
  Pose pose(ColliderId collider) const;      // now

  /// First hit of a ray on any cloth, and the closest point on any cloth, within `reach` [m]. Time grows with
  /// the number of triangles.
  std::optional<SurfacePoint> cast_ray(const Vec3& origin, const Vec3& direction, double reach = 1e30) const;
  std::optional<SurfacePoint> closest_point(const Vec3& point, double reach = 1e30) const;

  // Snapshots and saved worlds.

  /// State of all moving parts, with pins, targets and colliders; cheap next to a step. Stepping again after
  /// restore() gives the same bits. Valid for this world only, with the same cloths and colliders; else
  /// InputError.
  Snapshot snapshot() const;
  void restore(const Snapshot& snapshot);

  /// Serialises the world. A loaded world continues with the same bits, on any number of threads and any
  /// processor. The job system is not saved; ids are new: cloth(n), collider(n). load() throws InputError for
  /// damaged bytes or another version of the format.
  std::vector<std::byte> save() const;
  static World load(std::span<const std::byte> bytes);

  /// Hash of time, positions and velocities, bit by bit.
  std::uint64_t state_hash() const;

 private:
  friend struct WorldAccess;  // library internals
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace weft
