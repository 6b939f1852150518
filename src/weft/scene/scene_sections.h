#pragma once
/// Private to scene/: readers for sections of a scene file.

#include <filesystem>
#include <string_view>
#include <vector>

#include "weft/scene/scene_desc.h"
#include "weft/scene/toml_table.h"

namespace weft::engine {

/// A whole scene; mistakes are recorded in the document.
SceneDesc read_document(TomlDocument& document, const std::filesystem::path& file);

/// One [[cloth]], the `number`-th from 1. Mesh file names are relative to `folder`, the scene's folder.
ClothSceneDesc read_cloth(TomlTable cloth, int number, const std::filesystem::path& folder);

/// A cloth's pins, in both forms; `shape` is nullptr if it could not be read.
std::vector<PinDesc> read_pins(TomlTable& cloth, const std::variant<Grid, MeshSource>* shape);

/// Regions of stiffer or softer springs; `shape` as for pins.
std::vector<StiffenDesc> read_stiffened(TomlTable& cloth, const std::variant<Grid, MeshSource>* shape);

/// Regions with another length at rest; `shape` as for pins.
std::vector<RestScaleDesc> read_rest_scales(TomlTable& cloth, const std::variant<Grid, MeshSource>* shape);

/// The key "static_friction": at least `friction`.
void read_static_friction(TomlTable& table, double friction, double& static_friction);

/// One [[collider]], the `number`-th from 1. Mesh file names as for cloth.
ColliderSceneDesc read_collider(TomlTable collider, int number, const std::filesystem::path& folder);

/// The files that match a name with one star, sorted by name.
std::vector<std::filesystem::path> find_frame_files(const std::filesystem::path& pattern);

/// A fabric's SI numbers, validated one by one and together. Missing numbers are those of `base`.
/// `needs_all`: only damping and the numbers after it may be missing.
Fabric read_fabric_numbers(TomlTable& table, bool needs_all, const Fabric& base = {});

/// A file, named by `key`, which exists; empty if it is missing.
std::filesystem::path read_file_name(TomlTable& owner, std::string_view key,
                                     const std::filesystem::path& folder);

/// A mesh file, given by `key`, with the keys "up" and "scale".
MeshSource read_mesh_file(TomlTable& owner, std::string_view key, const std::filesystem::path& folder);

/// The key "motion" of a pin or collider: key frames with increasing times.
std::vector<KeyFrame> read_motion(TomlTable& owner);

/// A key frame's "time"; it must be later than that of the last key in `before`.
template <class Key>
bool read_time(TomlTable& table, const std::vector<Key>& before, Key& key) {
  table.require({"time"}, "a number in s");
  if (!table.read("time", key.time, any_number("s"))) return false;
  const bool is_later = before.empty() || key.time > before.back().time;
  if (!is_later) table.get("time").expected("a time after the previous key frame");
  return is_later;
}

}  // namespace weft::engine
