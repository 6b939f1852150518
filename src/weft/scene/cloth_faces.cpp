#include "weft/scene/cloth_faces.h"

#include <algorithm>
#include <array>

#include "weft/core/nearest_name.h"
#include "weft/error.h"
#include "weft/face/convert.h"
#include "weft/io/mesh_files.h"

namespace weft::engine {
namespace {

constexpr std::size_t kMaxNames = 12;  // in a message

std::string owner_of(const ClothSceneDesc& desc) { return "cloth \"" + desc.name + '"'; }

MeshFaces make_grid_faces(const Grid& grid) {
  MeshFaces cells;
  for (int j = 0; j < grid.cells_z; ++j) {
    for (int i = 0; i < grid.cells_x; ++i)
      cells.add(
          std::array{grid.index(i, j), grid.index(i, j + 1), grid.index(i + 1, j + 1), grid.index(i + 1, j)});
  }
  return cells;
}

[[noreturn]] void fail_group(const ClothSceneDesc& desc, const std::string& name,
                             const std::vector<std::string>& names) {
  const MeshSource* source = std::get_if<MeshSource>(&desc.shape);
  const bool is_file = source && !source->mesh;
  const std::string message = owner_of(desc) +
                              (is_file ? " (" + source->file.filename().string() + ")" : "") +
                              ": there is no group \"" + name + '"';
  if (!is_file)
    throw InputError(message + "; only meshes in files have groups, select an index, a box or a sphere");
  if (names.empty()) throw InputError(message + "; the file names no groups (lines g or o of an OBJ file)");
  const std::string nearest = find_nearest(name, names);
  throw InputError(message + (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?") +
                   (nearest.empty() ? "; there are " : " There are ") + list_names(names, kMaxNames));
}

}  // namespace

MeshFromFile read_mesh_of(const std::filesystem::path& file, const std::string& owner) {
  try {
    return engine::read_mesh(file);
  } catch (const InputError& error) {  // names the file and the line
    throw InputError(owner + ": " + error.what());
  }
}

MeshFaces read_faces(const ClothSceneDesc& desc) {
  if (const Grid* grid = std::get_if<Grid>(&desc.shape)) return make_grid_faces(*grid);
  const MeshSource& source = std::get<MeshSource>(desc.shape);
  if (source.mesh) return make_faces(source.mesh->triangles, to_engine(source.mesh->uv));
  return read_mesh_of(source.file, owner_of(desc)).faces;
}

std::vector<int> find_group(const ClothSceneDesc& desc, const std::string& name) {
  const MeshFaces faces = read_faces(desc);
  std::vector<int> vertices;
  std::vector<std::string> names;
  for (const MeshGroup& group : faces.groups) {
    if (std::find(names.begin(), names.end(), group.name) == names.end()) names.push_back(group.name);
    if (group.name != name) continue;
    for (const auto [begin, end] : group.faces)
      vertices.insert(vertices.end(), faces.corners.begin() + faces.begin_of(begin),
                      faces.corners.begin() + faces.begin_of(end));
  }
  if (vertices.empty()) fail_group(desc, name, names);
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

}  // namespace weft::engine
