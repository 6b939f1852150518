#include "view_open.h"

#include <algorithm>

#include "apps/common/command_line.h"
#include "weft/error.h"
#include "weft/io/mesh_files.h"
#include "weft/scene/fabric_reader.h"
#include "weft/scene/scene_library.h"
#include "weft/scene/tunables.h"

namespace weft::engine::app {
namespace {

namespace fs = std::filesystem;

constexpr double kAboveFloor = 0.05;  // of a mesh without a scene [m]

bool has_ending(const fs::path& path, std::initializer_list<const char*> endings) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

/// The folder of a run, or a .glb file.
bool is_run(const std::string& path) { return fs::is_directory(path) || has_ending(path, {".glb"}); }

Opened open_run(const ViewRequest& request) {
  const auto refuse = [&](bool is_given, const char* option) {
    if (is_given)
      throw InputError(std::string(option) + " does not apply to " + request.scene +
                       ": it is already simulated");
  };
  refuse(!request.overrides.empty(), "--set");
  refuse(!request.compare.empty(), "--compare");
  refuse(request.threads > 0, "--threads");
  Opened opened{.file = request.scene};
  opened.sides.push_back(std::make_unique<RunSide>(request.scene));
  return opened;
}

/// The mesh as a cloth that falls to a floor.
SceneDesc scene_of_mesh(const fs::path& file) {
  double lowest = 0;
  const MeshFromFile mesh = read_mesh(file);
  for (std::size_t v = 0; v < mesh.mesh.positions.size(); ++v)
    lowest = v == 0 ? mesh.mesh.positions[v].y() : std::min(lowest, mesh.mesh.positions[v].y());
  ClothSceneDesc cloth{.name = file.stem().string(), .shape = MeshSource{.file = fs::absolute(file)}};
  const FabricPreset& fabric = find_fabric_preset("cotton_shirting");
  cloth.fabric = FabricDesc{.name = fabric.name, .numbers = fabric.fabric};
  cloth.has_own_thickness = true;
  cloth.material = {.density = fabric.fabric.density,
                    .structural = 0,
                    .shear = 0,
                    .bend = 0,
                    .thickness = fabric.fabric.thickness,
                    .friction = fabric.fabric.friction};
  SceneDesc scene{.name = file.stem().string()};
  scene.cloths.push_back(std::move(cloth));
  scene.colliders.push_back(
      {.name = "floor", .shape = Plane{.point = {0, lowest - kAboveFloor, 0}, .normal = {0, 1, 0}}});
  return scene;
}

/// A scene, else a fabric; with the scene's mistakes if it is neither.
Opened open_toml(const ViewRequest& request) {
  Opened opened{.file = find_scene(request.scene)};
  try {
    opened.scene = read_scene(opened.file, request.overrides);
  } catch (const SceneError&) {
    try {
      opened.fabric = read_fabric_file(opened.file);
      return opened;
    } catch (const InputError&) {
    }
    throw;
  }
  return opened;
}

}  // namespace

bool is_integrator(const std::string& name) {
  return std::ranges::find(integrator_names(), name) != integrator_names().end();
}

void take_variant(const std::string& name, SceneDesc& scene) {
  if (is_integrator(name)) {
    scene.solver.integrator = name;
    return;
  }
  const FabricPreset* fabric = nullptr;
  try {
    fabric = &find_fabric_preset(name);
  } catch (const InputError& error) {
    throw InputError("--compare: no integrator has the name \"" + name + "\", and " + error.what());
  }
  for (ClothSceneDesc& cloth : scene.cloths) take_fabric(*fabric, cloth);
  settle_tunables(scene);
}

std::vector<std::unique_ptr<ViewSide>> make_sides(const ViewRequest& request, SceneDesc scene) {
  std::vector<std::string> names = request.compare;
  if (names.empty()) names = {scene.solver.integrator};
  const int count = static_cast<int>(names.size());
  const int threads =
      request.threads > 0 ? choose_threads(request.threads) : std::max(1, (num_processors() - 1) / count);
  std::vector<SceneDesc> variants(names.size(), scene);  // all of them, before a scene is built
  for (std::size_t k = 0; k < names.size(); ++k) take_variant(names[k], variants[k]);
  std::vector<std::unique_ptr<ViewSide>> sides;
  for (const SceneDesc& variant : variants) sides.push_back(std::make_unique<LiveSide>(variant, threads));
  return sides;
}

Opened open_view(const ViewRequest& request) {
  if (is_run(request.scene)) return open_run(request);
  Opened opened;
  if (has_ending(request.scene, {".obj", ".ply", ".stl"})) {
    if (!fs::exists(request.scene)) throw InputError("there is no file \"" + request.scene + '"');
    opened.scene = scene_of_mesh(request.scene);
    opened.file = request.scene;
  } else {
    opened = open_toml(request);
  }
  if (opened.scene) opened.sides = make_sides(request, *opened.scene);
  opened.compared = request.compare;
  return opened;
}

}  // namespace weft::engine::app
