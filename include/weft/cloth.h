#pragma once
/// What a cloth is made of, where it starts, and what holds it.

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "weft/collider.h"
#include "weft/fabric.h"
#include "weft/mesh.h"
#include "weft/vec.h"

namespace weft {

/// Which springs a grid has: `basic` two shear springs per cell (Provot), `simplified` one (the paper's),
/// `alternating` one whose direction changes from cell to cell, without the skew of `simplified`.
enum class SpringModel { basic, simplified, alternating };

/// How spring damping acts on the relative velocity of the two ends.
enum class DampingKind {
  plain,      // all of it: the paper's Eq. 2; also brakes a rigid rotation
  projected,  // only along the spring: leaves rigid motion alone
};

/// Cloth made of springs: its stiffness depends on the mesh.
struct Springs {
  double density = 0.2;      // mass per area, > 0 [kg/m²]
  double structural = 2000;  // stiffness of structural springs, >= 0 [N/m]
  double shear = 1000;       // of shear springs, >= 0; not used on meshes [N/m]
  double bend = 20;          // of bending springs, >= 0 [N/m]
  double damping = 0;        // of every spring, >= 0 [N·s/m]
  DampingKind damping_kind = DampingKind::projected;
  double thickness = 1e-3;  // cloth keeps half of it from colliders, all of it from itself, >= 0 [m]
  double friction = 0.3;    // Coulomb's coefficient of cloth on cloth, >= 0 [1]
};

/// What stretches and shears where a cloth is made of a fabric.
enum class Membrane {
  triangle,  // triangle elements; for `newton`, `implicit_euler` and `xpbd`
  springs,  // springs that come near the fabric; for every integrator's springs, with bending elements beside
};

struct ClothDesc {
  std::string name = {};  // for reports; empty: "cloth", "cloth 2", …

  /// At rest, in the cloth's own coordinates.
  std::variant<Grid, TriangleMesh> shape = {};
  std::string source = {};  // where the mesh is from, for messages: "shirt.obj"; may be empty

  /// A fabric in SI units (find_fabric("denim"), or numbers of your own), or springs.
  std::variant<Fabric, Springs> fabric = {};
  std::string fabric_name = "fabric";  // for messages
  Membrane membrane = Membrane::triangle;

  /// Direction of warp in the cloth's own coordinates, projected on every triangle. Empty: a mesh's texture
  /// coordinates say it (u); without them it is upwards on what stands and along x on what lies, with a
  /// warning; on a grid it is the x axis.
  std::optional<Vec3> warp = {};

  SpringModel model = SpringModel::alternating;  // of a grid: springs, and how cells are cut into triangles
  Pose pose = {};      // at the start, from the cloth's own coordinates to the world
  Vec3 velocity = {};  // of all particles at the start [m/s]

  /// Vertices of a mesh that lie within this distance become one; 0: exact duplicates; empty: none [m].
  std::optional<double> weld = {};

  /// Borders of a mesh's pieces within this distance are joined, vertex on vertex or not; layers, such as a
  /// lining, stay apart; 0: none [m].
  double sew = 0;

  /// Whether thickness is reduced to half of a mean edge where it is more: coarse meshes have few neighbours
  /// nearer than that.
  bool fits_thickness = true;
};

/// What became of a cloth's mesh.
struct ClothNotes {
  std::vector<int> particle_of_vertex =
      {};  // (vertices given) the particle of each, -1: dropped; of a grid 0, 1, …
  std::vector<std::string> warnings = {};  // flaws of the mesh and of the fabric on it, in sentences
  std::vector<std::string> done = {};      // what was done as asked: welded, sewn; in sentences
};

/// Particles that are held. They follow `motion`, or go where World::move_pins() puts them.
struct Pin {
  std::vector<int> particles = {};
  std::vector<KeyFrame> motion = {};  // of all of them, from where they are when pinned; empty: they stay
  Vec3 pivot = {};                    // what the motion turns about [m]

  /// Empty: held exactly, as by a clamp. A number: by a damped spring each, which the cloth can stretch;
  /// `motion` must then be empty. >= 0 [N/m].
  std::optional<double> stiffness = {};
  double damping = 0;  // of that spring, against all motion of the particle, >= 0 [N·s/m]
};

}  // namespace weft
