#pragma once
/// Scene to draw: lists of meshes, lines and dots, with a camera. Independent of physics.

#include <array>
#include <optional>
#include <vector>

#include "weft/fabric.h"
#include "weft/mesh/triangle_mesh.h"
#include "weft/render/camera.h"

namespace weft::engine {

using Color = std::array<double, 3>;  // linear red, green, blue in [0, 1]

struct Look {
  enum class Kind { fabric, solid };

  Kind kind = Kind::solid;
  Color color = {0.6, 0.6, 0.6};
  double check_size = 0;      // of the fabric's checks, in fabric coordinates; 0: none [m]
  weft::FabricLook fabric{};  // weave and reflection of fabric
};

/// A triangle mesh; vertex normals are computed from its triangles.
struct DrawnMesh {
  std::vector<Triangle> triangles;
  std::vector<float> positions;           // (num_vertices x 3) [m]
  std::vector<float> fabric_coordinates;  // (num_vertices x 2) along warp and weft at rest; empty: none [m]
  std::vector<float> values = {};  // (num_vertices) shown by colours, instead of the look's; empty: none
  std::array<double, 2> range = {0, 1};  // values of the first and the last colour, in ascending order
  Look look;
};

/// Straight lines of uniform colour, with depth test against meshes.
struct DrawnLines {
  std::vector<Vec3> ends;  // (2 x num_lines) [m]
  Color color = {0.1, 0.1, 0.1};
  double width = 1.5;  // [pixels]
};

/// Small balls of constant size on screen.
struct DrawnDots {
  std::vector<Vec3> positions;  // [m]
  Color color = {0.1, 0.1, 0.1};
  double diameter = 6;  // [pixels]
};

struct Light {
  Vec3 to_sun = Vec3(-0.55, 0.95, 0.45).normalized();  // unit [1]
  Color sun = {2.7, 2.5, 2.2};
  Color sky = {0.95, 1.0, 1.1};       // from above
  Color ground = {0.72, 0.66, 0.60};  // from below
  double exposure = 0.34;             // exposure: multiplier of the light before tone mapping [1]
};

struct Picture {
  Camera camera;
  Light light;
  std::vector<DrawnMesh> meshes;
  std::vector<DrawnLines> lines;
  std::vector<DrawnDots> dots;
  std::optional<double> ground;  // height of the ground that receives shadows; empty: none [m]
  bool transparent = false;      // no sky and no ground; alpha is coverage
};

}  // namespace weft::engine
