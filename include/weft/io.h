#pragma once
/// Mesh files, point caches, and their conversion. Link weft::scene.

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "weft/collider.h"
#include "weft/export.h"
#include "weft/mesh.h"

namespace weft {

/// A named part of a mesh. A face may be in several.
struct MeshGroup {
  std::string name = {};
  bool is_object = false;       // of an OBJ file: named by a line o, not by a line g
  std::vector<int> faces = {};  // at least one, from 0, ascending
  bool operator==(const MeshGroup&) const = default;
};

/// The faces of a mesh as a file has them: polygons.
struct MeshFaces {
  std::vector<int> sizes = {};                 // (num_faces) corners of each face, 3 or more
  std::vector<int> corners = {};               // vertices of the first face, then of the second, …
  std::vector<std::array<double, 2>> uv = {};  // (corners) u, v, NaN where there are none; or empty
  std::vector<MeshGroup> groups = {};          // in the order of their first faces
  std::vector<std::array<int, 2>> lines =
      {};  // vertices joined by a line l of an OBJ file, as Blender's sewing
};

struct MeshFromFile {
  TriangleMesh mesh = {};  // vertices in the file's order; quads and polygons cut into triangles
  std::vector<std::string> warnings = {};  // unknown keywords, as sentences
  MeshFaces faces =
      {};  // as in the file; a face of n corners is n - 2 triangles of the mesh, face after face
};

/// Reads a Wavefront OBJ file. Throws InputError ("FILE:LINE: …") for an unusable one.
WEFT_API MeshFromFile read_obj(const std::string& file);

/// Writes an OBJ file, with enough digits to read the same numbers back. Throws InputError if it cannot be
/// written.
WEFT_API void write_obj(const std::string& file, const TriangleMesh& mesh);

/// The same of polygons. Throws InputError also for faces of other vertices, and for lists that do not fit each
/// other. A group's name must be one word, an object's words, without # and without a backslash at the end.
WEFT_API void write_obj(const std::string& file, const std::vector<Vec3>& vertices, const MeshFaces& faces);

/// Reads a PLY (`.ply`), STL (`.stl`) or glTF (`.glb`, `.gltf`) file, of the last all meshes at the start of its
/// first animation; any other is read as Wavefront OBJ. Throws InputError for an unusable one.
WEFT_API MeshFromFile read_mesh(const std::string& file);

/// Writes an OBJ (`.obj`) or PLY (`.ply`) file, from which the same numbers are read back. Throws InputError
/// for another ending, and if it cannot be written.
WEFT_API void write_mesh(const std::string& file, const TriangleMesh& mesh);

/// The same of polygons; errors as of write_obj(). PLY files have no groups.
WEFT_API void write_mesh(const std::string& file, const std::vector<Vec3>& vertices, const MeshFaces& faces);

/// Cuts polygons into triangles, concave ones too. `corners` are the positions of all corners, polygon by
/// polygon, `counts` the numbers of corners, each at least 3. The triangles are of corners: indices of
/// `corners`. Throws InputError for other counts.
WEFT_API std::vector<Triangle> triangulate(const std::vector<Vec3>& corners, const std::vector<int>& counts);

/// Area-weighted unit normals of the vertices (num_vertices x 3); up at vertices without area around.
/// `positions` are (num_vertices x 3) [m]. Throws InputError for triangles of other vertices.
WEFT_API std::vector<float> vertex_normals(const std::vector<Triangle>& triangles,
                                           std::span<const float> positions);

struct GltfOptions {
  std::string node = {};  // its meshes and those below it are the body; "": all of the default scene
  std::string clip = {};  // animation; "": the first one, if there is one
  double scale = 1;       // length of the file's unit, > 0 [m]
};

struct BodyFromFile {
  TriangleMesh mesh = {};                  // at the start of the clip; uv as in MeshFromFile
  VertexMotion motion = {};                // by the clip; empty if nothing moves
  std::string clip = {};                   // its name; "": none
  std::vector<std::string> warnings = {};  // ignored parts of the file, as sentences
};

/// Reads the meshes of a glTF 2.0 file (.glb, .gltf) as a body that moves, with its skins, morph targets and
/// nodes. Give `mesh` and `motion` to a ColliderDesc. Throws InputError ("FILE: PLACE: …") for an unusable
/// file, and for a node or clip that is not in it.
WEFT_API BodyFromFile read_gltf(const std::string& file, const GltfOptions& options = {});

/// A point cache, PC2 (`.pc2`) or MDD (`.mdd`): positions of the same points at every frame. The frames are
/// read one by one. Every call throws InputError ("FILE: byte N: …") for a damaged file.
class WEFT_API PointCacheFile {
 public:
  explicit PointCacheFile(const std::string& file);
  ~PointCacheFile();
  PointCacheFile(PointCacheFile&&) noexcept;
  PointCacheFile& operator=(PointCacheFile&&) noexcept;

  int num_points() const;                 // >= 1
  int num_frames() const;                 // >= 0
  std::vector<float> times() const;       // of the frames; empty: the file does not say them [s]
  std::vector<float> frame(int k) const;  // k in [0, num_frames()): (num_points x 3), finite

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes a point cache, PC2 (`.pc2`) or MDD (`.mdd`), frame by frame. An earlier file stays until finish().
/// Every call throws InputError if the file cannot be written.
class WEFT_API PointCacheWriter {
 public:
  /// `times` of all frames; a PC2 file holds their number only [s]. Throws InputError for another ending and
  /// for fewer than one point.
  PointCacheWriter(const std::string& file, int num_points, const std::vector<float>& times);
  ~PointCacheWriter();
  PointCacheWriter(PointCacheWriter&&) noexcept;
  PointCacheWriter& operator=(PointCacheWriter&&) noexcept;

  void add_frame(std::span<const float> positions);  // (num_points x 3), finite

  /// Completes the file, which needs a frame for every time. Call once.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

struct ConvertOptions {
  std::optional<double> fps = {};  // of point caches that do not say it, > 0; default 60 [1/s]
  bool up_is_z = false;            // of the input: rotated, so that its z axis becomes the output's y axis
  double scale = 1;                // length of the input's unit, > 0 [m]
  int first_frame = 0;             // of a point cache, >= 0
  std::optional<int> last_frame = {};  // default: the last one
  std::string mesh = {};               // file of the mesh of a point cache's points, to write meshes
};

struct Converted {
  std::vector<std::string> files = {};  // written
  std::vector<std::string> notes = {};  // what a format could not say or hold, and absurd sizes, as sentences
};

/// `in` is a mesh (OBJ, PLY, STL, glTF), a point cache (PC2, MDD), or the folder of a run. `out` is a file of
/// the same kind (OBJ, PLY; PC2, MDD), by its ending; the meshes of a glTF file also become a point cache. Of a
/// run with several cloths each has its own file: `walk.mdd` becomes `walk_skirt.mdd`. Point caches also become
/// a sequence of meshes, `walk_0000.obj` being frame 0. A run has their mesh, another cache needs `mesh`. Frames
/// are read and written one by one. Throws InputError for files that cannot be read, written or converted; an
/// earlier file of that name then stays as it was.
WEFT_API Converted convert(const std::string& in, const std::string& out, const ConvertOptions& options = {});

}  // namespace weft
