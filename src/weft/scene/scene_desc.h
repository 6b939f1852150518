#pragma once
/// A scene as plain data: what a scene file says, checked and with defaults filled in.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "weft/animation/rigid_motion.h"
#include "weft/contact/collider.h"
#include "weft/core/shapes.h"
#include "weft/fabric.h"
#include "weft/mesh.h"
#include "weft/forces/wind.h"
#include "weft/integrators/integrator.h"
#include "weft/mesh/grid.h"
#include "weft/model/cloth_model.h"
#include "weft/model/springs.h"

namespace weft::engine {

struct GridCorner {
  int i = 0, j = 0;  // 0 or 1 each: which end of the first and of the second axis
  bool operator==(const GridCorner&) const = default;
};

struct ParticleIndices {
  std::vector<int> indices;  // on a grid j * (cells_x + 1) + i; on a mesh the file's vertices, counted from 0
  bool operator==(const ParticleIndices&) const = default;
};

using ParticleSelection =
    std::variant<GridCorner, ParticleIndices, Box, Sphere>;  // regions: initial position, world

struct PinDesc {
  ParticleSelection select;
  std::vector<KeyFrame> motion;  // empty: held still
  Vec3 pivot = Vec3::Zero();     // what `motion` turns about [m]
  bool operator==(const PinDesc&) const = default;
};

/// Springs that are stiffer or softer than the cloth's others: those with both ends in the selection.
struct StiffenDesc {
  ParticleSelection select;
  double factor = 1;  // what their stiffness is multiplied by, >= 0 [1]
  bool operator==(const StiffenDesc&) const = default;
};

/// A mesh in a file or in memory, and how it is taken over.
struct MeshSource {
  std::filesystem::path file;   // resolved against the scene file's folder
  std::shared_ptr<const weft::TriangleMesh> mesh;  // in memory, instead of a file
  bool up_is_z = false;         // turned first, so that its z axis becomes the world's y axis
  double scale = 1;             // of the file's unit, > 0 [m]
  bool weld = false;            // sew vertices that coincide
  double weld_distance = 1e-6;  // within this distance, >= 0 [m]
  double sew_distance = 0;      // a cloth's: sew borders within this distance, vertex on vertex or not [m]
  bool operator==(const MeshSource&) const = default;
};

/// A collider's mesh, where it is at the start.
struct PlacedMesh {
  MeshSource source;                          // of a sequence: the first frame's
  std::vector<std::filesystem::path> frames;  // of a sequence, in order, the first one too; empty: none
  std::vector<std::vector<Vec3>> frame_positions;  // likewise in memory, of (num_vertices) each; in the
                                                   // source's unit and axes [m]
  std::filesystem::path rest;                 // pose before SceneDesc::settle; empty: that of the start
  double frame_rate = 30;                     // of a sequence, > 0 [1/s]
  Vec3 position = Vec3::Zero();               // added after the rotation [m]
  Vec3 rotation_deg = Vec3::Zero();  // about fixed x, then y, then z, around the mesh's own origin [degrees]
  bool operator==(const PlacedMesh&) const = default;
};

/// A box, where it is at the start.
struct PlacedBox {
  Vec3 center = Vec3::Zero();            // [m]
  Vec3 half_size = Vec3::Constant(0.5);  // along its own axes, > 0 [m]
  Vec3 rotation_deg = Vec3::Zero();      // about fixed x, then y, then z, around its centre [degrees]
  bool operator==(const PlacedBox&) const = default;
};

struct ColliderSceneDesc {
  std::string name;  // default: "collider", "collider 2", …
  std::variant<Sphere, Plane, Capsule, PlacedBox, PlacedMesh> shape;
  double friction = Collider().friction;  // Coulomb's coefficient, >= 0 [1]
  double static_friction = 0;             // while nothing slides; less than `friction`: the same [1]
  RigidMotion motion;
  bool operator==(const ColliderSceneDesc&) const = default;
};

/// What a cloth is made of, in SI units.
struct FabricDesc {
  std::string name;  // for messages
  Fabric numbers;
  Membrane membrane = Membrane::triangle;
  std::optional<Vec3> warp;  // in the cloth's own coordinates, projected on every triangle; empty: a mesh's
                             // texture coordinates say it (warp = u), on a grid it is the first axis
  bool operator==(const FabricDesc&) const = default;
};

struct ClothSceneDesc {
  std::string name;  // default: "cloth", "cloth 2", …
  std::variant<Grid, MeshSource> shape;
  SpringModel model = SpringModel::simplified;  // of a fabric on a grid: alternating
  ClothMaterial material;                       // with a fabric: its density, thickness and friction alone
  bool has_own_thickness = false;               // else the material's, but no more than half of a mean edge
  std::optional<FabricDesc> fabric;             // empty: `material` has the stiffness of springs
  Vec3 position = Vec3::Zero();                 // added after the rotation [m]
  Vec3 rotation_deg = Vec3::Zero();  // about fixed x, then y, then z, around the cloth's own origin [degrees]
  Vec3 velocity = Vec3::Zero();      // at the start [m/s]
  std::array<double, 3> color = {0.58, 0.06, 0.05};  // linear red, green, blue [0, 1]
  std::vector<PinDesc> pins;
  std::vector<StiffenDesc> stiffened;  // of springs alone; factors multiply where selections overlap
  bool operator==(const ClothSceneDesc&) const = default;
};

/// Of two things by their names, in place of what they say themselves.
struct ContactDesc {
  std::array<std::string, 2> between;  // cloths and colliders, one cloth at least; a cloth twice: with itself
  std::optional<double> friction;      // Coulomb's coefficient, >= 0 [1]
  double static_friction = 0;          // while nothing slides; only with `friction` [1]
  bool collide = true;                 // false: they go through each other
  bool operator==(const ContactDesc&) const = default;
};

struct WindDesc {
  double drag = 0;            // c_w [N·s/m³]
  Air air;                    // density 0: none
  Gusts gusts;                // besides the keys' velocity
  std::vector<WindKey> keys;  // at least one if there is drag or air; linear between, constant outside
  bool operator==(const WindDesc&) const = default;
};

/// What to do with a start at which cloth crosses something, after it has been untangled if that is wished.
enum class CrossedStart {
  refuse,  // by an InputError that names it
  allow,   // warn of it, and run
};

struct SceneDesc {
  std::string name;              // the file's name without ending, with its folders below one called "scenes"
  std::string description;       // one line
  Vec3 gravity = {0, -9.81, 0};  // [m/s²]
  double fps = 60;               // frames per second, > 0
  /// Time that is simulated before frame 0, at which cloth is then at rest: it settles on bodies that stand as
  /// they do at the start, and meshes with a rest pose move from it to there; >= 0 [s].
  double settle = 0;
  double duration = 3;           // [s], > 0
  std::vector<ClothSceneDesc> cloths;  // at least one
  std::vector<ColliderSceneDesc> colliders;
  std::vector<ContactDesc> contacts;
  WindDesc wind;
  IntegratorSettings solver;
  int steps_per_frame = 1;       // >= 1
  std::optional<bool> adaptive;  // whether steps are divided where they are too long; empty: with newton
  int max_steps_per_frame = 16;  // into as many in all, >= 1
  bool contact = true;           // whether colliders, cloth itself and other cloths hold cloth off
  bool untangle = true;          // set apart what crosses at the start, where there is contact
  CrossedStart crossed_start = CrossedStart::refuse;

  int num_frames() const;      // round(duration · fps), at least 1
  double step_length() const;  // 1 / (fps · steps_per_frame) [s]
  bool operator==(const SceneDesc&) const = default;
};

}  // namespace weft::engine
