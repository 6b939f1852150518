#include "weft/run/past_run.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "weft/core/file_name.h"
#include "weft/core/hash.h"
#include "weft/error.h"
#include "weft/io/pc2.h"
#include "weft/run/file_sinks.h"
#include "weft/run/run_folder.h"
#include "weft/scene/scene_writer.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

PastRun read_results(const fs::path& folder) {
  const fs::path list = folder / kRunName;
  std::ifstream stream(list);
  const Json json = Json::parse(stream, nullptr, false);
  const auto fail = [&] { throw InputError(list.string() + ": not the list of a run's files"); };
  const auto text = [&](const Json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  const auto file = [&](const Json& object, const char* key) {
    const fs::path name = fs::path(text(object, key)).filename();
    return name.empty() ? name : folder / name;
  };
  if (!json.is_object() || !json.contains("cloths") || !json["cloths"].is_array() || json["cloths"].empty())
    fail();
  PastRun run{.folder = folder};
  if (const auto fps = json.find("fps"); fps != json.end()) {
    if (!fps->is_number() || !(fps->get<double>() > 0)) fail();
    run.fps = fps->get<double>();
  }
  for (const Json& cloth : json["cloths"]) {
    if (!cloth.is_object() || text(cloth, "name").empty()) fail();
    run.cloths.push_back({text(cloth, "name"), file(cloth, "positions"), file(cloth, "mesh")});
  }
  run.name = text(json, "scene");
  run.animation = file(json, "animation");
  run.report = file(json, "report");
  if (!text(json, "scene_hash").empty()) run.scene = folder / kAsRunName / kSceneName;
  run.scene_hash = text(json, "scene_hash");
  return run;
}

PastRun read_results_so_far(const fs::path& folder) {
  const UnfinishedRun unfinished = read_unfinished_run(folder);
  PastRun run{.folder = folder, .name = unfinished.scene.name, .fps = unfinished.scene.fps};
  if (unfinished.options.glb) run.frames = folder / kUnfinishedName / kFramesName;
  FileNames names;
  for (const ClothSceneDesc& cloth : unfinished.scene.cloths) {
    const std::string name = names.add(cloth.name);
    PastCloth& past = run.cloths.emplace_back(PastCloth{.name = cloth.name});
    if (!unfinished.options.pc2) continue;
    past.cache = folder / kUnfinishedName / (name + kCacheEnding);
    past.mesh = folder / kUnfinishedName / (name + kMeshEnding);
  }
  return run;
}

}  // namespace

PastRun read_past_run(const fs::path& folder) {
  if (fs::exists(folder / kRunName)) return read_results(folder);
  if (fs::exists(folder / kUnfinishedName / kCheckpointName)) return read_results_so_far(folder);
  throw InputError(folder.string() + " holds no run: there is no " + kRunName);
}

PastCounts read_counts(const PastRun& run) {
  PastCounts counts;
  std::ifstream stream(run.report);
  const Json json = Json::parse(stream, nullptr, false);
  const auto read = [&](const char* key, std::vector<int>& series) {
    if (!json.is_object() || !json.contains(key) || !json[key].is_array()) return;
    for (const Json& count : json[key]) series.push_back(count.is_number_integer() ? count.get<int>() : 0);
  };
  read("divisions", counts.divisions);
  read("newton_steps", counts.newton_steps);
  read("cg_iterations", counts.cg_iterations);
  return counts;
}

std::string hash_of_scene(const SceneDesc& scene) {
  Hash hash;
  hash.add(std::span<const char>(scene_text_with_hashes(scene)));
  return to_hex(hash.value());
}

std::unique_ptr<PointCacheReader> open_cache(const PastRun& run, const PastCloth& cloth) {
  if (cloth.cache.empty())
    throw InputError(run.folder.string() + " has no point cache of cloth \"" + cloth.name +
                     "\": it was run with --no-pc2");
  return std::make_unique<Pc2Reader>(cloth.cache);
}

}  // namespace weft::engine
