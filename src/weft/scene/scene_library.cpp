#include "weft/scene/scene_library.h"

#ifndef _WIN32
#include <dlfcn.h>
#endif

#include <algorithm>
#include <cstdlib>
#include <system_error>

#include "weft/core/nearest_name.h"
#include "weft/error.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

bool is_folder(const fs::path& path) {
  std::error_code not_there;
  return fs::is_directory(path, not_there);
}

/// The running program; empty where the system does not report it.
fs::path program_file() {
  std::error_code unknown;
  return fs::read_symlink("/proc/self/exe", unknown);
}

/// The library or program that holds this code; empty where the system does not report it.
fs::path library_file() {
#ifndef _WIN32
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&list_scenes), &info) == 0 || !info.dli_fname) return {};
  std::error_code unknown;
  return fs::canonical(info.dli_fname, unknown);
#else
  return {};
#endif
}

/// The folders above a file, nearest first.
std::vector<fs::path> folders_above(const fs::path& file) {
  std::vector<fs::path> folders;
  for (fs::path folder = file.parent_path(); !folder.empty(); folder = folder.parent_path()) {
    folders.push_back(folder);
    if (folder == folder.parent_path()) break;
  }
  return folders;
}

/// "fig6_ball" is accepted for "paper/fig6_ball" too.
std::string find_nearest_scene(const std::string& name, const std::vector<ShippedScene>& scenes) {
  std::vector<std::string> names, last_parts;
  for (const ShippedScene& scene : scenes) {
    names.push_back(scene.name);
    last_parts.push_back(scene.file.stem().string());
  }
  const std::string nearest = find_nearest(name, names);
  if (!nearest.empty()) return nearest;
  const auto last_part = std::find(last_parts.begin(), last_parts.end(), find_nearest(name, last_parts));
  return last_part == last_parts.end() ? "" : names[last_part - last_parts.begin()];
}

std::string describe_missing(const std::string& name) {
  const std::vector<ShippedScene> scenes = list_scenes();
  const std::string message = "no scene file or shipped scene is named \"" + name + "\"";
  const std::string nearest = find_nearest_scene(name, scenes);
  if (!nearest.empty()) return message + "; did you mean \"" + nearest + "\"?";
  std::string known;
  for (const ShippedScene& scene : scenes) known += (known.empty() ? "" : ", ") + scene.name;
  return message + "; available: " + known;
}

}  // namespace

std::filesystem::path find_scene_folder(const fs::path& library, const fs::path& program) {
  for (const fs::path& binary : {library, program}) {
    for (const fs::path& prefix : folders_above(binary)) {
      const fs::path scenes = prefix / "share" / "weft" / "scenes";
      if (is_folder(scenes)) return scenes;
    }
  }
  std::error_code not_there;
  for (const fs::path& binary : {library, program}) {
    for (const fs::path& tree : folders_above(binary)) {
      const bool is_source = fs::exists(tree / "include" / "weft" / "weft.h", not_there);
      if (is_source && is_folder(tree / "scenes")) return tree / "scenes";
    }
  }
  return {};
}

std::filesystem::path scene_folder() {
  if (const char* folder = std::getenv("WEFT_SCENES")) {
    if (is_folder(folder)) return folder;
    throw InputError("WEFT_SCENES is \"" + std::string(folder) + "\", expected a folder with scenes");
  }
  const fs::path folder = find_scene_folder(library_file(), program_file());
  if (!folder.empty()) return folder;
  throw InputError("the shipped scenes are not found; set WEFT_SCENES to their folder");
}

std::vector<ShippedScene> list_scenes() {
  const fs::path folder = scene_folder();
  std::vector<ShippedScene> scenes;
  constexpr auto kOptions = fs::directory_options::skip_permission_denied;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder, kOptions)) {
    if (!entry.is_regular_file() || entry.path().extension() != ".toml") continue;
    fs::path name = entry.path().lexically_relative(folder);
    scenes.push_back({name.replace_extension().generic_string(), entry.path()});
  }
  std::sort(scenes.begin(), scenes.end(),
            [](const ShippedScene& a, const ShippedScene& b) { return a.name < b.name; });
  return scenes;
}

std::filesystem::path find_scene(const std::string& file_or_name) {
  std::error_code not_there;
  const fs::path file = file_or_name;
  if (fs::exists(file, not_there) && !is_folder(file)) return file;
  for (const ShippedScene& scene : list_scenes()) {
    if (scene.name == file_or_name) return scene.file;
  }
  throw InputError(describe_missing(file_or_name));
}

}  // namespace weft::engine
