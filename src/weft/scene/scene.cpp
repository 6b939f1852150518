/// Public functions: scenes.

#include "weft/scene.h"

#include <cstdint>
#include <nlohmann/json.hpp>

#include "weft/scene/scene_access.h"
#include "weft/scene/scene_library.h"
#include "weft/scene/scene_writer.h"
#include "weft/scene/toml_document.h"

namespace weft {
namespace {

nlohmann::json to_json(const toml::node& node) {
  if (const toml::table* table = node.as_table()) {
    nlohmann::json object = nlohmann::json::object();
    for (const auto& [key, value] : *table) object[std::string(key.str())] = to_json(value);
    return object;
  }
  if (const toml::array* array = node.as_array()) {
    nlohmann::json list = nlohmann::json::array();
    for (const toml::node& value : *array) list.push_back(to_json(value));
    return list;
  }
  if (const auto value = node.value_exact<std::string>()) return *value;
  if (const auto value = node.value_exact<std::int64_t>()) return *value;
  if (const auto value = node.value_exact<double>()) return *value;
  return node.value_exact<bool>().value();  // a valid scene has no dates
}

}  // namespace

Scene Scene::load(const std::string& file_or_name, const std::vector<std::string>& overrides) {
  const std::filesystem::path file = engine::find_scene(file_or_name);
  const std::string text = engine::read_scene_text(file);
  return Scene(
      std::make_shared<State>(State{text, file, overrides, engine::parse_scene(text, file, overrides)}));
}

Scene Scene::parse(const std::string& toml, const std::string& file) {
  return Scene(std::make_shared<State>(State{toml, file, {}, engine::parse_scene(toml, file)}));
}

void Scene::set(const std::string& assignment) {
  State next = *state_;
  next.overrides.push_back(assignment);
  next.desc = engine::parse_scene(next.text, next.file, next.overrides);
  state_ = std::make_shared<State>(std::move(next));
}

std::string Scene::to_json() const {
  engine::TomlDocument document(state_->text, state_->file.generic_string());
  for (const std::string& assignment : state_->overrides) document.override_value(assignment);
  return weft::to_json(document.root()).dump(2);
}

std::string Scene::name() const { return state_->desc.name; }
double Scene::frames_per_second() const { return state_->desc.fps; }
int Scene::steps_per_frame() const { return state_->desc.steps_per_frame; }
int Scene::num_frames() const { return state_->desc.num_frames(); }
double Scene::step() const { return state_->desc.step_length(); }

void Scene::write(const std::string& file) const { engine::write_scene(file, state_->desc); }

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (engine::ShippedScene& scene : engine::list_scenes()) names.push_back(std::move(scene.name));
  return names;
}

}  // namespace weft
