#pragma once
/// World: cloths, colliders, pins and wind, and their steps through time. Everything is in SI units.
///
/// Threads: calls on different worlds may run at the same time. On one world any number of const calls may run
/// at the same time, but no call beside one that is not const.

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

/// Which forces on particles are meant.
enum class ForceKind {
  gravity,
  elastic,   // of springs, membranes, strain limits and bending
  damping,   // inside the cloth
  wind,      // of the wind's drag, the air's drag and lift
  external,  // given by set_forces()
  contact,   // of the last step, each on the nearest particle; needs ContactSettings::tracks_points
};

/// The state of a world at a moment; see World::snapshot().
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

/// Every call throws InputError for ids that are empty, of another world or of something removed, and for
/// numbers that cannot be; the world is then as it was before the call.
class WEFT_API World {
 public:
  World();
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;  // not copyable: see clone()

  /// Another world in the same state, which goes on with the same bits and shares nothing that changes but
  /// the job system.
  World clone() const;

  // Cloths and colliders.

  /// Throws InputError for a mesh that cannot be cloth, and for a fabric with an integrator that moves springs
  /// only.
  ClothId add_cloth(const ClothDesc& desc);
  ColliderId add_collider(const ColliderDesc& desc);
  void remove(ClothId cloth);  // with its pins, forces, and rules of friction and collision
  void remove(ColliderId collider);
  bool contains(ClothId cloth) const;
  bool contains(ColliderId collider) const;
  int num_cloths() const;
  int num_colliders() const;
  ClothId cloth(int n) const;  // the n-th of those that are there, in the order in which they were added
  ColliderId collider(int n) const;  // likewise
  std::string name(ClothId cloth) const;
  std::string name(ColliderId collider) const;
  const ClothNotes& notes(ClothId cloth) const;
  const std::vector<std::string>& warnings(ColliderId collider) const;  // flaws of its mesh, in sentences

  /// Sets cloth apart that crosses itself, other cloth or colliders where it is now. Pinned particles stay,
  /// velocities are kept, and everything stays where it is if that does not help. Takes seconds for thousands
  /// of particles, and nothing where nothing crosses. Returns what still crosses, in sentences.
  std::vector<std::string> untangle();

  // Between two steps: what moves by the program.

  /// Where a collider is at the end of the next step, as a pose from its own coordinates to the world. Until
  /// then its pivot moves evenly, and it turns evenly about one axis, the shorter way: give turns of more than
  /// half a turn in several steps. Not given again it stands still. Replaces its key frames.
  void move_collider(ColliderId collider, const Pose& at_end);

  /// Puts a collider somewhere now, without sweeping cloth on the way.
  void place_collider(ColliderId collider, const Pose& pose);

  /// The same for the vertices of a mesh collider, as many as it was given, in its own coordinates [m]. The
  /// pose stays.
  void move_vertices(ColliderId collider, const std::vector<Vec3>& at_end);
  void place_vertices(ColliderId collider, const std::vector<Vec3>& positions);

  void set_pins(ClothId cloth, const std::vector<Pin>& pins);  // in place of the pins before

  /// Where pinned particles are at the end of the next step, one position for each, in the order of the pins'
  /// lists; until then they move evenly. Not given again they stay. Replaces the pins' key frames.
  void move_pins(ClothId cloth, const std::vector<Vec3>& at_end);

  /// External forces, one for each particle; they act until they are set again. Empty: none [N].
  void set_forces(ClothId cloth, const std::vector<Vec3>& forces);

  // State from outside. Nothing is swept on the way, and pins hold where their particles are put.

  void set_positions(ClothId cloth, const std::vector<Vec3>& positions);    // velocities stay [m]
  void set_velocities(ClothId cloth, const std::vector<Vec3>& velocities);  // [m/s]

  /// Moves a whole cloth by p ↦ rotation p + translation, in the world's coordinates. Velocities turn along,
  /// or become zero.
  void teleport(ClothId cloth, const Pose& displacement, bool keeps_velocity = true);

  // Settings; the next step uses them.

  void set_fabric(ClothId cloth, const std::variant<Fabric, Springs>& fabric);  // the rest shape stays
  void stiffen(ClothId cloth, const std::vector<int>& particles,
               double factor);  // springs with both ends there
  void set_friction(ColliderId collider, double friction, double static_friction = 0);
  void set_friction(BodyId a, BodyId b, double friction, double static_friction = 0);  // of this pair only
  void set_collision(BodyId a, BodyId b, bool collide);  // cloth with itself: the same id twice
  void set_gravity(const Vec3& gravity);                 // [m/s²]
  void set_wind(const Wind& wind);
  void set_integrator(const IntegratorSettings& settings);
  void set_division(const StepDivision& division);
  void set_contact(const ContactSettings& settings);
  void set_jobs(std::shared_ptr<JobSystem> jobs);  // threads; the result does not depend on them

  // Time.

  /// Advances everything by dt > 0 [s].
  StepReport step(double dt);
  double time() const;  // [s]

  // Reading cloth. Arrays are by particle. Pointers take three numbers a particle, `stride` bytes apart.

  int num_particles(ClothId cloth) const;
  const std::vector<Triangle>& triangles(ClothId cloth) const;  // of particles
  std::vector<Vec3> positions(ClothId cloth) const;             // [m]
  std::vector<Vec3> velocities(ClothId cloth) const;            // [m/s]
  std::vector<double> masses(ClothId cloth) const;              // [kg]
  void copy_positions(ClothId cloth, float* out, std::size_t stride = 3 * sizeof(float)) const;
  void copy_positions(ClothId cloth, double* out, std::size_t stride = 3 * sizeof(double)) const;
  void copy_velocities(ClothId cloth, float* out, std::size_t stride = 3 * sizeof(float)) const;
  void copy_velocities(ClothId cloth, double* out, std::size_t stride = 3 * sizeof(double)) const;
  void copy_normals(ClothId cloth, float* out, std::size_t stride = 3 * sizeof(float)) const;  // of length 1
  void copy_normals(ClothId cloth, double* out, std::size_t stride = 3 * sizeof(double)) const;

  /// Positions of the vertices that add_cloth was given, in their order: welded ones together, dropped ones
  /// where they were at the start [m].
  std::vector<Vec3> vertex_positions(ClothId cloth) const;

  // Measuring. Computed in double precision when asked for.

  std::vector<Vec3> forces(ClothId cloth, ForceKind kind) const;  // on each particle [N]

  /// What each pinned particle is held with, in the order of the pins' lists: its mass times its acceleration
  /// in the last step, less all other forces at its end. Zero before the first step. Contacts count only where
  /// they are tracked [N].
  std::vector<Vec3> pin_forces(ClothId cloth) const;

  std::vector<double> spring_strains(
      ClothId cloth) const;  // length over rest length − 1, of every spring [1]
  std::vector<TriangleStrain> triangle_strains(ClothId cloth) const;
  std::vector<ContactPoint> contact_points() const;  // of the last step, where they are tracked
  Energies energies() const;
  Vec3 momentum(ClothId cloth) const;        // [kg·m/s]
  Vec3 center_of_mass(ClothId cloth) const;  // [m]
  Pose pose(ColliderId collider) const;      // now

  /// The first point of any cloth on a ray, and the point of any cloth nearest to a point, within `reach` [m].
  /// Time grows with the number of triangles.
  std::optional<SurfacePoint> cast_ray(const Vec3& origin, const Vec3& direction, double reach = 1e30) const;
  std::optional<SurfacePoint> closest_point(const Vec3& point, double reach = 1e30) const;

  // Going back, and elsewhere.

  /// Everything that moves, with pins, targets and colliders; cheap next to a step. Restoring it and stepping
  /// again gives the same bits again. Of this world only, with the same cloths and colliders; else InputError.
  Snapshot snapshot() const;
  void restore(const Snapshot& snapshot);

  /// The whole world as bytes, and from them again: it goes on with the same bits, on any number of threads
  /// and any processor. Without its job system; ids are new: cloth(n), collider(n). load() throws InputError
  /// for bytes that are damaged or of another version of the format.
  std::vector<std::byte> save() const;
  static World load(std::span<const std::byte> bytes);

  /// Of time, positions and velocities, bit by bit.
  std::uint64_t state_hash() const;

 private:
  friend struct WorldAccess;  // of the library
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace weft
