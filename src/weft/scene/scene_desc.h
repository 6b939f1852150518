#pragma once
/// A scene as plain data: the contents of a scene file, checked and with defaults filled in.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "weft/animation/rigid_motion.h"
#include "weft/cloth.h"
#include "weft/contact/collider.h"
#include "weft/core/shapes.h"
#include "weft/fabric.h"
#include "weft/forces/wind.h"
#include "weft/integrators/integrator.h"
#include "weft/mesh.h"
#include "weft/mesh/grid.h"
#include "weft/model/cloth_model.h"
#include "weft/model/springs.h"

namespace weft::engine {

/// Called while a scene is prepared: see RunOptions::on_preparation.
using OnPreparation = std::function<void(const std::string& what)>;

struct GridCorner {
  int i = 0, j = 0;  // 0 or 1 each: the end of the first and of the second axis
  bool operator==(const GridCorner&) const = default;
};

struct ParticleIndices {
  std::vector<int> indices;  // on a grid j * (cells_x + 1) + i; on a mesh the file's vertices, counted from 0
  bool operator==(const ParticleIndices&) const = default;
};

struct GroupName {
  std::string name;  // of a group or an object of the mesh's file: the vertices of its faces
  bool operator==(const GroupName&) const = default;
};

using ParticleSelection =
    std::variant<GridCorner, ParticleIndices, GroupName, Box, Sphere>;  // regions: initial position, world

struct PinDesc {
  ParticleSelection select;
  std::vector<KeyFrame> motion;     // empty: held still
  Vec3 pivot = Vec3::Zero();        // centre of the rotation of `motion` [m]
  std::string follow;               // name of the collider whose surface they follow; "": none
  std::optional<double> stiffness;  // of a spring per particle; empty: held exactly [N/m]
  double damping = 0;               // of that spring [N·s/m]
  /// Whether it holds its particles still, exactly.
  bool is_still() const { return motion.empty() && follow.empty() && !stiffness; }
  bool operator==(const PinDesc&) const = default;
};

/// A region of stiffer or softer springs: those with both ends in the selection.
struct StiffenDesc {
  ParticleSelection select;
  double factor = 1;  // of their stiffness, >= 0 [1]
  bool operator==(const StiffenDesc&) const = default;
};

/// A mesh in a file or in memory, with the conversions on import.
struct MeshSource {
  std::filesystem::path file;                      // resolved against the scene file's folder
  std::shared_ptr<const weft::TriangleMesh> mesh;  // in memory, instead of a file
  bool up_is_z = false;         // rotated first, so that its z axis becomes the world's y axis
  double scale = 1;             // length of the file's unit, > 0 [m]
  bool weld = false;            // sew vertices that coincide
  double weld_distance = 1e-6;  // within this distance, >= 0 [m]
  double sew_distance = 0;      // cloth: sew borders within this distance, vertex on vertex or not [m]
  bool operator==(const MeshSource&) const = default;
};

/// Another rest shape of a mesh: the pattern in its texture coordinates, or a mesh with the same faces.
struct RestDesc {
  std::optional<MeshSource> mesh;  // empty: texture coordinates
  std::optional<double> uv_scale;  // as in rest_from_uv(), > 0 [m]
  bool operator==(const RestDesc&) const = default;
};

/// A part of a cloth that is smaller or larger at rest.
struct RestScaleDesc {
  ParticleSelection select;
  double warp = 1, weft = 1;  // as in RestScale, > 0 [1]
  bool operator==(const RestScaleDesc&) const = default;
};

/// A collider's mesh with its initial pose.
struct PlacedMesh {
  MeshSource source;                               // of a sequence: the first frame's
  std::vector<std::filesystem::path> frames;       // of a sequence, in order, with the first one; empty: none
  std::vector<std::vector<Vec3>> frame_positions;  // the same in memory, (num_vertices) each; in the
                                                   // source's unit and axes [m]
  std::string node, clip;                          // of a glTF file, as in GltfOptions
  std::optional<double> start_time;                // of the clip, at time 0; empty: its first key [s]
  std::optional<bool> solid;                       // as in ColliderDesc
  std::filesystem::path rest;                      // pose before SceneDesc::settle; empty: that of the start
  double frame_rate = 30;                          // of a sequence, > 0 [1/s]
  Vec3 position = Vec3::Zero();                    // added after the rotation [m]
  Vec3 rotation_deg = Vec3::Zero();  // about fixed x, then y, then z, around the mesh's own origin [degrees]
  bool operator==(const PlacedMesh&) const = default;
};

/// A box with its initial pose.
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
  double static_friction = 0;             // of sticking contacts; less than `friction`: the same [1]
  RigidMotion motion;
  bool operator==(const ColliderSceneDesc&) const = default;
};

/// The fabric of a cloth, in SI units.
struct FabricDesc {
  std::string name;  // for messages
  Fabric numbers;
  Membrane membrane = Membrane::triangle;
  std::optional<Vec3> warp;  // in the cloth's own coordinates, projected on every triangle; empty: from the
                             // texture coordinates of a mesh (warp = u), on a grid the first axis
  bool operator==(const FabricDesc&) const = default;
};

struct ClothSceneDesc {
  std::string name;  // default: "cloth", "cloth 2", …
  std::variant<Grid, MeshSource> shape;
  std::optional<RestDesc> rest;                 // of a mesh; empty: the mesh
  std::vector<RestScaleDesc> rest_scales;       // with a fabric; factors multiply where selections overlap
  SpringModel model = SpringModel::simplified;  // of a fabric on a grid: alternating
  ClothMaterial material;                       // with a fabric: only its density, thickness and friction
  bool has_own_thickness = false;               // else the material's, at most half of the mean edge
  std::optional<FabricDesc> fabric;             // empty: `material` has the stiffness of springs
  Vec3 position = Vec3::Zero();                 // added after the rotation [m]
  Vec3 rotation_deg = Vec3::Zero();  // about fixed x, then y, then z, around the cloth's own origin [degrees]
  Vec3 velocity = Vec3::Zero();      // at the start [m/s]
  double pressure = 0;               // of gas inside closed cloth, in excess of the air outside [Pa]
  bool is_sealed = false;            // the gas keeps its amount, which has `pressure` at the start
  int layer = 0;                     // as in ClothDesc
  std::vector<Seam> seams;
  bool has_stitches = false;                         // the lines of its file draw together like seams
  double seam_time = 1;                              // in which they close, >= 0 [s]
  std::optional<double> seam_stiffness;              // as in ClothDesc, >= 0 [N/m²]
  std::array<double, 3> color = {0.58, 0.06, 0.05};  // linear red, green, blue [0, 1]
  std::vector<PinDesc> pins;
  std::vector<StiffenDesc> stiffened;  // springs only; factors multiply where selections overlap
  bool operator==(const ClothSceneDesc&) const = default;
};

/// Contact settings of a pair of bodies, given by their names; they override the settings of the bodies.
struct ContactDesc {
  std::array<std::string, 2> between;  // cloths and colliders, one cloth at least; a cloth twice: with itself
  std::optional<double> friction;      // Coulomb's coefficient, >= 0 [1]
  double static_friction = 0;          // of sticking contacts; only with `friction` [1]
  bool collide = true;                 // false: they do not collide
  bool operator==(const ContactDesc&) const = default;
};

struct WindDesc {
  double drag = 0;            // c_w [N·s/m³]
  Air air;                    // density 0: none
  Gusts gusts;                // besides the keys' velocity
  std::vector<WindKey> keys;  // at least one if there is drag or air; linear between, constant outside
  bool operator==(const WindDesc&) const = default;
};

/// Response to initial intersections of cloth; with `untangle`, to those that remain.
enum class CrossedStart {
  refuse,  // InputError that names the intersection
  allow,   // warning
};

struct SceneDesc {
  std::string name;              // the file's name without ending, with its folders below one called "scenes"
  std::string description;       // one line
  Vec3 gravity = {0, -9.81, 0};  // [m/s²]
  double fps = 60;               // frames per second, > 0
  /// Time that is simulated before frame 0, at which cloth is then at rest: it settles on bodies that stand as
  /// they do at the start, and meshes with a rest pose move from it to there; >= 0 [s].
  double settle = 0;
  double duration = 3;                 // [s], > 0
  std::vector<ClothSceneDesc> cloths;  // at least one
  std::vector<ColliderSceneDesc> colliders;
  std::vector<ContactDesc> contacts;
  WindDesc wind;
  IntegratorSettings solver;
  int steps_per_frame = 1;       // >= 1
  std::optional<bool> adaptive;  // divides steps that are too long; empty: only with newton
  int max_steps_per_frame = 64;  // limit of that division, >= 1
  bool contact = true;           // of cloth with colliders, itself and other cloths
  bool untangle = true;          // removes initial intersections, if `contact`
  CrossedStart crossed_start = CrossedStart::refuse;

  int num_frames() const;      // round(duration · fps), at least 1
  double step_length() const;  // 1 / (fps · steps_per_frame) [s]
  bool operator==(const SceneDesc&) const = default;
};

}  // namespace weft::engine
