/// The table of parameters, from the reader's queries.

#include "weft/parameters.h"

#include <algorithm>
#include <map>
#include <utility>

#include "weft/core/nearest_name.h"
#include "weft/error.h"
#include "weft/scene/parameter_texts.h"
#include "weft/scene/scene_sections.h"

namespace weft {
namespace engine {
namespace {

/// Files that together make the reader query every key; they need not be valid scenes.
constexpr std::string_view kKeySamples[] = {
    R"([scene]
[[cloth]]
grid = {}
[cloth.fabric]
c11 = 1
[[cloth.pin]]
select = { box = {} }
motion = [{}]
[[cloth.stiffen]]
[[cloth.rest_scale]]
[[cloth.seam]]
[[collider]]
shape = "sphere"
motion = [{}]
[[collider]]
shape = "plane"
[[collider]]
shape = "capsule"
[[collider]]
shape = "box"
[[collider]]
shape = "mesh"
frames = 0
[[contact]]
[wind]
keys = [{}]
air = {}
gusts = {}
)",
    R"([scene]
[[cloth]]
mesh = 0
[cloth.rest]
[cloth.fabric]
spring_structural = 1
[[cloth.pin]]
select = { sphere = {} }
[[collider]]
shape = "mesh"
file = "body.glb"
)"};

class Collector {
 public:
  void add(const TomlDocument& document) {
    for (const TomlSection& section : document.sections()) {
      std::vector<Parameter>& table = tables_[section.path];
      for (const Parameter& note : section.notes) add(table, note);
      for (const std::string& key : section.keys) queried_.emplace_back(section.path, key);
    }
    for (const TomlSection& section : document.sections()) add_requirements(section);
  }

  /// Keys that the reader queries without documentation; the tests refuse them, because they have no text.
  void add_undocumented() {
    for (const auto& [path, key] : queried_) {
      if (!has(tables_[path], key)) tables_[path].push_back({.key = key});
    }
  }

  /// Each table by forms, then the tables that it contains.
  void append_to(std::vector<Parameter>& all, const std::string& path = "") const {
    const auto table = tables_.find(path);
    if (table == tables_.end()) return;
    for (const std::string& form : forms_of(table->second)) {
      for (Parameter p : table->second) {
        if (p.form != form) continue;
        p.key = join(path, p.key);
        p.description = find_text(p);
        if (p.required) p.default_value.clear();
        all.push_back(std::move(p));
      }
    }
    for (const Parameter& p : table->second) append_to(all, join(path, p.key));
  }

 private:
  static std::string join(const std::string& path, const std::string& key) {
    return path.empty() ? key : path + "." + key;
  }

  static bool has(const std::vector<Parameter>& table, const std::string& key) {
    return std::any_of(table.begin(), table.end(), [&](const Parameter& p) { return p.key == key; });
  }

  static void add(std::vector<Parameter>& table, const Parameter& note) {
    const bool is_known = std::any_of(table.begin(), table.end(), [&](const Parameter& p) {
      return p.key == note.key && p.form == note.form;
    });
    if (!is_known) table.push_back(note);
  }

  void add_requirements(const TomlSection& section) {
    for (const TomlSection::Requirement& r : section.required) {
      for (Parameter& p : tables_[section.path]) {
        if (std::find(r.one_of.begin(), r.one_of.end(), p.key) == r.one_of.end()) continue;
        p.required = true;
        p.alternatives = r.one_of;
        std::erase(p.alternatives, p.key);
      }
    }
  }

  /// In the order of their first keys, keys of every form first.
  static std::vector<std::string> forms_of(const std::vector<Parameter>& table) {
    std::vector<std::string> forms = {""};
    for (const Parameter& p : table) {
      if (std::find(forms.begin(), forms.end(), p.form) == forms.end()) forms.push_back(p.form);
    }
    return forms;
  }

  static std::string find_text(const Parameter& p) {
    for (const ParameterText& text : parameter_texts()) {
      if (text.key == p.key && text.form == p.form) return std::string(text.description);
    }
    return "";
  }

  std::map<std::string, std::vector<Parameter>> tables_;      // by path, in the order of queries
  std::vector<std::pair<std::string, std::string>> queried_;  // path of the table, key
};

std::vector<Parameter> collect_parameters() {
  Collector collector;
  for (const std::string_view sample : kKeySamples) {
    TomlDocument document(sample, "sample");
    read_document(document, "sample");
    collector.add(document);
  }
  collector.add_undocumented();
  std::vector<Parameter> all;
  collector.append_to(all);
  return all;
}

}  // namespace
}  // namespace engine

const std::vector<Parameter>& parameters() {
  static const std::vector<Parameter> all = engine::collect_parameters();
  return all;
}

const Parameter& find_parameter(std::string_view key, std::string_view form) {
  std::vector<std::string> keys, forms;
  for (const Parameter& p : parameters()) {
    if (p.key == key && (form.empty() || p.form == form)) return p;
    keys.push_back(p.key);
    if (p.key == key) forms.push_back(p.form);
  }
  const std::string name = "\"" + std::string(key) + "\"";
  if (!forms.empty()) throw InputError("parameter " + name + " has no form \"" + std::string(form) + "\"");
  const std::string nearest = engine::find_nearest(key, keys);
  throw InputError("unknown parameter " + name +
                   (nearest.empty() ? "; parameters() has all" : "; did you mean \"" + nearest + "\"?"));
}

}  // namespace weft
