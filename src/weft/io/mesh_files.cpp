#include "weft/io/mesh_files.h"

#include "weft/error.h"
#include "weft/io/gltf_body.h"
#include "weft/io/mdd.h"
#include "weft/io/obj_reader.h"
#include "weft/io/pc2.h"
#include "weft/io/ply.h"
#include "weft/io/stl.h"
#include "weft/io/words.h"

namespace weft::engine {

bool has_ending(const std::filesystem::path& file, const char* ending) {
  return to_lower(file.extension().string()) == ending;
}

bool is_gltf(const std::filesystem::path& file) {
  return has_ending(file, ".glb") || has_ending(file, ".gltf");
}

Vec3 to_world(const Vec3& p, bool up_is_z, double scale) {
  return scale * (up_is_z ? Vec3(p.x(), p.z(), -p.y()) : p);
}

MeshFromFile read_mesh(const std::filesystem::path& file) {
  if (has_ending(file, ".ply")) return read_ply(file);
  if (has_ending(file, ".stl")) return read_stl(file);
  if (is_gltf(file)) return mesh_at_start(read_gltf_body(file));
  return read_obj(file);
}

std::vector<Vec3> read_vertices(const std::filesystem::path& file, const MeshFromFile& first) {
  const bool is_other = has_ending(file, ".ply") || has_ending(file, ".stl") || is_gltf(file);
  std::vector<Vec3> positions;
  if (is_other) {
    MeshFromFile mesh = read_mesh(file);
    if (mesh.faces.corners != first.faces.corners || mesh.faces.ends != first.faces.ends)
      throw InputError(file.string() + ": its faces are not those of the first file" + kSameFaces);
    positions = std::move(mesh.mesh.positions);
  } else {
    positions = read_obj_vertices(file, first.faces);
  }
  if (positions.size() != first.mesh.positions.size())
    throw InputError(file.string() + ": has " + std::to_string(positions.size()) +
                     " vertices, the first file " + std::to_string(first.mesh.positions.size()) + kSameFaces);
  return positions;
}

void write_mesh(const std::filesystem::path& file, const std::vector<Vec3>& positions,
                const MeshFaces& faces) {
  if (has_ending(file, ".obj")) return write_obj(file, positions, faces);
  if (has_ending(file, ".ply")) return write_ply(file, positions, faces);
  throw InputError(file.string() + ": a mesh is written as .obj or .ply");
}

std::unique_ptr<PointCacheReader> open_point_cache(const std::filesystem::path& file) {
  if (has_ending(file, ".pc2")) return std::make_unique<Pc2Reader>(file);
  if (has_ending(file, ".mdd")) return std::make_unique<MddReader>(file);
  throw InputError(file.string() + ": expected a point cache, .pc2 or .mdd");
}

}  // namespace weft::engine
