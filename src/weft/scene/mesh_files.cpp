/// Public functions for mesh files.

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "weft/error.h"
#include "weft/face/convert.h"
#include "weft/face/vertex_motion.h"
#include "weft/io.h"
#include "weft/io/gltf_body.h"
#include "weft/io/mesh_files.h"
#include "weft/io/obj_reader.h"
#include "weft/mesh/vertex_normals.h"

namespace weft {
namespace {

MeshGroup from_engine(const engine::MeshGroup& group) {
  MeshGroup result{.name = group.name, .is_object = group.is_object};
  for (const auto& [begin, end] : group.faces) {
    for (int face = begin; face < end; ++face) result.faces.push_back(face);
  }
  return result;
}

MeshFaces from_engine(engine::MeshFaces&& faces) {
  MeshFaces result{.corners = std::move(faces.corners), .lines = std::move(faces.lines)};
  for (std::size_t f = 0; f < faces.size(); ++f)
    result.sizes.push_back(static_cast<int>(faces.ends[f] - faces.begin_of(f)));
  for (const Eigen::Vector2d& uv : faces.uv) result.uv.push_back({uv.x(), uv.y()});
  for (const engine::MeshGroup& group : faces.groups) result.groups.push_back(from_engine(group));
  return result;
}

MeshFromFile from_engine(engine::MeshFromFile&& read) {
  return {engine::from_engine(read.mesh, read.uv), std::move(read.warnings),
          from_engine(std::move(read.faces))};
}

engine::MeshGroup to_engine(const MeshGroup& group, std::size_t num_faces, const std::string& who) {
  engine::MeshGroup result{.name = group.name, .is_object = group.is_object, .faces = {}};
  if (group.faces.empty()) throw InputError(who + "group \"" + group.name + "\" has no faces");
  for (const int face : group.faces) {
    const int next = result.faces.empty() ? 0 : result.faces.back().end;
    if (face < next || static_cast<std::size_t>(face) >= num_faces)
      throw InputError(who + "group \"" + group.name + "\" has face " + std::to_string(face) +
                       "; expected ascending numbers from 0 to " + std::to_string(num_faces - 1));
    if (!result.faces.empty() && face == next)
      ++result.faces.back().end;
    else
      result.faces.push_back({face, face + 1});
  }
  return result;
}

/// Throws InputError for two objects with the same face.
void require_apart(const std::vector<engine::MeshGroup>& groups, const std::string& who) {
  std::vector<engine::FaceRange> taken;
  for (const engine::MeshGroup& group : groups) {
    if (group.is_object) taken.insert(taken.end(), group.faces.begin(), group.faces.end());
  }
  std::ranges::sort(taken, {}, &engine::FaceRange::begin);
  for (std::size_t k = 1; k < taken.size(); ++k) {
    if (taken[k].begin < taken[k - 1].end)
      throw InputError(who + "face " + std::to_string(taken[k].begin) +
                       " is in two objects; expected one at most");
  }
}

engine::MeshFaces to_engine(const MeshFaces& faces, std::size_t num_vertices, const std::string& who) {
  engine::MeshFaces result{.corners = faces.corners, .ends = {}, .uv = {}, .groups = {}, .lines = {}};
  std::size_t end = 0;
  for (const int size : faces.sizes) {
    if (size < 3)
      throw InputError(who + "a face has " + std::to_string(size) + " corners; expected 3 or more");
    result.ends.push_back(end += static_cast<std::size_t>(size));
  }
  if (end != faces.corners.size())
    throw InputError(who + "the faces have " + std::to_string(end) + " corners together, but there are " +
                     std::to_string(faces.corners.size()));
  for (const int v : faces.corners) {
    if (v < 0 || static_cast<std::size_t>(v) >= num_vertices)
      throw InputError(who + "a face has vertex " + std::to_string(v) + " of " +
                       std::to_string(num_vertices));
  }
  if (!faces.uv.empty() && faces.uv.size() != end)
    throw InputError(who + "texture coordinates of " + std::to_string(faces.uv.size()) +
                     " corners; expected " + std::to_string(end) + " or none");
  for (const auto& [u, v] : faces.uv) result.uv.emplace_back(u, v);
  for (const MeshGroup& group : faces.groups)
    result.groups.push_back(to_engine(group, faces.sizes.size(), who));
  require_apart(result.groups, who);
  for (const auto& line : faces.lines) {
    for (const int v : line) {
      if (v < 0 || static_cast<std::size_t>(v) >= num_vertices)
        throw InputError(who + "a line has vertex " + std::to_string(v) + " of " +
                         std::to_string(num_vertices));
    }
  }
  result.lines = faces.lines;
  return result;
}

engine::MeshFaces to_faces(const TriangleMesh& mesh, const std::string& who) {
  if (!mesh.uv.empty() && mesh.uv.size() != mesh.triangles.size())
    throw InputError(who + "texture coordinates of " + std::to_string(mesh.uv.size()) +
                     " triangles; expected " + std::to_string(mesh.triangles.size()) + " or none");
  MeshFaces faces{.sizes = std::vector<int>(mesh.triangles.size(), 3)};
  for (const Triangle& triangle : mesh.triangles)
    faces.corners.insert(faces.corners.end(), triangle.begin(), triangle.end());
  for (const CornerUv& uv : mesh.uv) faces.uv.insert(faces.uv.end(), uv.begin(), uv.end());
  return to_engine(faces, mesh.positions.size(), who);
}

}  // namespace

MeshFromFile read_obj(const std::string& file) { return from_engine(engine::read_obj(file)); }

void write_obj(const std::string& file, const TriangleMesh& mesh) {
  engine::write_obj(file, engine::to_engine(mesh.positions), to_faces(mesh, file + ": "));
}

void write_obj(const std::string& file, const std::vector<Vec3>& vertices, const MeshFaces& faces) {
  engine::write_obj(file, engine::to_engine(vertices), to_engine(faces, vertices.size(), file + ": "));
}

MeshFromFile read_mesh(const std::string& file) { return from_engine(engine::read_mesh(file)); }

void write_mesh(const std::string& file, const TriangleMesh& mesh) {
  engine::write_mesh(file, engine::to_engine(mesh.positions), to_faces(mesh, file + ": "));
}

void write_mesh(const std::string& file, const std::vector<Vec3>& vertices, const MeshFaces& faces) {
  engine::write_mesh(file, engine::to_engine(vertices), to_engine(faces, vertices.size(), file + ": "));
}

std::vector<Triangle> triangulate(const std::vector<Vec3>& corners, const std::vector<int>& counts) {
  engine::MeshFromFile cut;
  cut.mesh.positions = engine::to_engine(corners);
  std::vector<int> polygon;
  std::size_t first = 0;
  for (const int count : counts) {
    if (count < 3)
      throw InputError("a polygon has " + std::to_string(count) + " corners; expected 3 or more");
    polygon.resize(count);
    std::iota(polygon.begin(), polygon.end(), static_cast<int>(first));
    first += polygon.size();
    if (first > corners.size()) break;
    engine::append_polygon(polygon, {}, cut);
  }
  if (first != corners.size())
    throw InputError("the polygons have not " + std::to_string(corners.size()) +
                     " corners together, the number of positions");
  return cut.mesh.triangles;
}

std::vector<float> vertex_normals(const std::vector<Triangle>& triangles, std::span<const float> positions) {
  for (const Triangle& triangle : triangles) {
    for (const int v : triangle) {
      if (v < 0 || 3 * static_cast<std::size_t>(v) + 2 >= positions.size())
        throw InputError("a triangle has vertex " + std::to_string(v) + " of " +
                         std::to_string(positions.size() / 3));
    }
  }
  return engine::compute_vertex_normals(triangles, positions);
}

BodyFromFile read_gltf(const std::string& file, const GltfOptions& options) {
  if (!(std::isfinite(options.scale) && options.scale > 0))
    throw InputError(file + ": the scale must be above 0");
  engine::GltfBody body = engine::read_gltf_body(file, options);
  const engine::MeshFromFile start = mesh_at_start(body);
  BodyFromFile result{.mesh = engine::from_engine(start.mesh, start.uv),
                      .clip = std::move(body.clip),
                      .warnings = std::move(body.warnings)};
  if (!body.vertices.is_still())
    result.motion =
        VertexMotionAccess::make(std::make_shared<const engine::SkinnedMesh>(std::move(body.vertices)));
  return result;
}

}  // namespace weft
