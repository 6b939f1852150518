#pragma once
/// Cloth: shape, material, initial state and pins.

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "weft/collider.h"
#include "weft/fabric.h"
#include "weft/ids.h"
#include "weft/mesh.h"
#include "weft/vec.h"

namespace weft {

/// Springs of a grid: `basic` has two shear springs per cell (Provot), `simplified` one (the paper's),
/// `alternating` one whose direction alternates from cell to cell, without the skew of `simplified`.
enum class SpringModel { basic, simplified, alternating };

/// Spring damping: the part of the two ends' relative velocity that it acts on.
enum class DampingKind {
  plain,      // all of it: the paper's Eq. 2; also brakes a rigid rotation
  projected,  // only the component along the spring: does not damp rigid motion
};

/// Cloth made of springs. Its stiffness depends on the mesh.
struct Springs {
  double density = 0.2;      // mass per area, > 0 [kg/m²]
  double structural = 2000;  // stiffness of structural springs, >= 0 [N/m]
  double shear = 1000;       // of shear springs, >= 0; not used on meshes [N/m]
  double bend = 20;          // of bending springs, >= 0 [N/m]
  double damping = 0;        // of every spring, >= 0 [N·s/m]
  DampingKind damping_kind = DampingKind::projected;
  double thickness = 1e-3;  // distance between layers; half of it to colliders, >= 0 [m]
  double friction = 0.3;    // Coulomb coefficient of cloth on cloth, >= 0 [1]
};

/// Discretisation of stretching and shearing, for cloth made of a fabric.
enum class Membrane {
  triangle,  // triangle elements; for `newton`, `implicit_euler` and `xpbd`
  springs,   // springs fitted to the fabric, with bending elements; for the same integrators
};

/// Two stretches of border that are sewn together: the first vertex of `a` to the first of `b`, the last to the
/// last, and between them points at equal shares of the two lengths, at vertices or not.
struct Seam {
  /// Vertices of the shape on its borders, in order, at least two each; from one to the next the shorter way
  /// along the border. Around a whole border: four, of which the last is the first.
  std::vector<int> a = {}, b = {};

  bool operator==(const Seam&) const = default;
};

/// A part of a cloth that is smaller or larger at rest: elastic, gathers, shrinkage. Factors multiply where parts
/// overlap; a triangle has the mean of its corners' factors.
struct RestScale {
  std::vector<int> vertices = {};  // of the shape
  double warp = 1, weft = 1;       // factors of lengths along warp and weft, > 0 [1]

  bool operator==(const RestScale&) const = default;
};

struct ClothDesc {
  std::string name = {};  // for reports; empty: "cloth", "cloth 2", …

  /// Shape at the start, in the cloth's own coordinates, and at rest without `rest` and `rest_scales`.
  std::variant<Grid, TriangleMesh> shape = {};

  /// Triangles at rest: of each of the mesh's the places of its corners, in its order. Only lengths count, so they
  /// may lie anywhere, apart from each other too. rest_from_uv() gives a pattern's. Empty: those of the mesh.
  std::vector<TriangleCorners> rest = {};
  std::vector<RestScale> rest_scales = {};  // for cloth made of a fabric

  std::string source = {};  // file of the mesh, for messages: "shirt.obj"; may be empty

  /// A fabric in SI units (find_fabric("denim"), or your own numbers), or springs.
  std::variant<Fabric, Springs> fabric = {};
  std::string fabric_name = "fabric";  // for messages
  Membrane membrane = Membrane::triangle;

  /// Warp direction in the cloth's own coordinates, projected on every triangle. Empty: the u direction of a
  /// mesh's texture coordinates. Without those, upwards on upright cloth and along x on lying cloth, with a
  /// warning. On a grid, the x axis.
  std::optional<Vec3> warp = {};

  SpringModel model = SpringModel::alternating;  // of a grid: springs, and how cells are cut into triangles
  Pose pose = {};      // initial pose, from the cloth's own coordinates to the world
  Vec3 velocity = {};  // initial velocity of all particles [m/s]

  /// Merges vertices of a mesh within this distance; 0: exact duplicates; empty: none [m].
  std::optional<double> weld = {};

  /// Joins borders of a mesh's pieces within this distance, at vertices or between them; layers, such as a
  /// lining, stay separate; 0: none [m].
  double sew = 0;

  /// Seams of panels, which draw together within `seam_time`, and then hold, with borders 1.2 thicknesses
  /// apart. For `newton`, `implicit_euler` and `xpbd`; not on grids of springs.
  std::vector<Seam> seams = {};

  /// Pairs of vertices that draw together likewise, such as the sewing edges of Blender. Empty: none.
  std::vector<std::array<int, 2>> stitches = {};
  double seam_time = 1;  // from the start distance to closed, >= 0 [s]

  /// Tension per opening of the seams, >= 0; empty: that of the cloth's edges beside them [N/m²].
  std::optional<double> seam_stiffness = {};

  /// Order of garments worn over each other. World::untangle() moves a cloth outside of those with lower
  /// numbers, away from the nearest closed collider; equal numbers have no order.
  int layer = 0;

  /// Whether to reduce the thickness to half the mean edge length where it is larger, so that few neighbours
  /// on coarse meshes are nearer than the thickness.
  bool fits_thickness = true;
};

/// Results of a cloth's mesh preparation.
struct ClothNotes {
  std::vector<int> particle_of_vertex =
      {};  // (input vertices) particle of each, -1: dropped; of a grid 0, 1, …
  std::vector<std::string> warnings = {};  // flaws of the mesh and of its fabric, as sentences
  std::vector<std::string> done = {};      // requested changes: welded, sewn; as sentences
};

/// Pinned particles. They follow `motion`, a collider, or the targets of World::move_pins().
struct Pin {
  std::vector<int> particles = {};
  std::vector<KeyFrame> motion = {};  // of all of them, relative to where they were pinned; empty: fixed
  Vec3 pivot = {};                    // centre of the motion's rotation [m]

  /// A collider that the particles follow, as if glued to it where they are when pinned: to the nearest
  /// triangle of a mesh, to any other shape as a rigid body. `motion` must then be empty.
  std::optional<ColliderId> follow = {};

  /// Empty: held exactly, as by a clamp. A number: stiffness of a damped spring per particle, which the cloth
  /// can stretch; `motion` must then be empty. >= 0 [N/m].
  std::optional<double> stiffness = {};
  double damping = 0;  // of that spring, on the particle's absolute velocity, >= 0 [N·s/m]
};

}  // namespace weft
