#pragma once
/// Reader for moving bodies: the meshes of any glTF 2.0 file (.glb, .gltf), with skins, morph targets and
/// animations.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "weft/animation/skinned_mesh.h"
#include "weft/io.h"
#include "weft/io/mesh_from_file.h"
#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

struct GltfClip {
  std::string name;           // "animation 2" if the file gives none
  double start = 0, end = 0;  // first and last key [s]

  double seconds() const { return end - start; }
};

struct GltfContents {
  std::vector<std::string> nodes;  // with meshes; "node 3" if the file gives no name
  std::vector<GltfClip> clips;
};

/// A body that moves by a clip. Coordinates are the file's, times `scale`: y up, metres.
struct GltfBody {
  SkinnedMesh vertices;             // a part for each node with a mesh; its primitives one after another
  std::vector<Triangle> triangles;  // counter-clockwise seen from the front. Those with equal corners, which
                                    // connect strips, are left out.
  std::vector<Eigen::Vector2d> uv;  // (num_vertices) TEXCOORD_0, v down; NaN for primitives without;
                                    // empty if there are none at all
  std::string clip;                 // "": at rest
  GltfContents contents;            // of the whole file
  std::vector<std::string> warnings;  // ignored parts of the file, one message each, with counts
};

/// Reads a body. Buffers are in the file, in data URIs, or in files in its folder or below. Materials, pictures,
/// cameras, lights and normals are ignored. A vertex whose joint weights are all 0 follows its first joint.
///
/// Throws InputError, "FILE: PLACE: mistake" ("arm.glb: mesh 2, primitive 0: POSITION: …"), for
/// - a file that cannot be read, is damaged, or breaks a rule of glTF that affects the body,
/// - a required extension that is not supported (compression),
/// - a node or clip that is not in the file, with the names that are,
/// - a body without triangles.
GltfBody read_gltf_body(const std::filesystem::path& file, const GltfOptions& options = {});

/// The same from the file's bytes; `name` is the file name in messages. Never reads another file.
GltfBody parse_gltf_body(std::span<const unsigned char> bytes, const std::string& name,
                         const GltfOptions& options = {});

/// The mesh at the start of the clip.
MeshFromFile mesh_at_start(const GltfBody& body);

/// Names of the nodes with meshes, and of the clips.
GltfContents list_gltf(const std::filesystem::path& file);

}  // namespace weft::engine
