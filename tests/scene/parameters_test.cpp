/// The table of parameters: complete texts, defaults and ranges equal to the reader's, no text written twice.

#include "weft/parameters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "weft/error.h"
#include "weft/scene/parameter_texts.h"
#include "weft/scene/scene_reader.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = WEFT_SOURCE_DIR;

/// Scenes that together have every table in every form.
const std::vector<std::string> kScenes = {
    R"([scene]
format = 1
[[cloth]]
grid = { size = [1, 1], cells = [4, 4] }
fabric = { g = 45 }
[[cloth.pin]]
select = { box = { min = [0, 0, 0], max = [1, 1, 1] } }
motion = [{ time = 0 }]
[[cloth.rest_scale]]
select = { box = { min = [0, 0, 0], max = [1, 1, 1] } }
[[cloth.seam]]
a = [0, 4]
b = [20, 24]
[[collider]]
shape = "sphere"
radius = 1
friction = 0
motion = [{ time = 0 }]
[[contact]]
between = ["cloth", "collider"]
friction = 0
[wind]
velocity = [1, 0, 0]
air = {}
gusts = { strength = 1 }
)",
    R"([scene]
format = 1
[[cloth]]
grid = { size = [1, 1], cells = [4, 4] }
fabric = { density = 0.01, c11 = 2800, bend_warp = 6e-6 }
[[collider]]
shape = "plane"
)",
    R"([scene]
format = 1
[[cloth]]
grid = { size = [1, 1], cells = [4, 4] }
[[cloth.pin]]
select = { index = [0] }
[[cloth.stiffen]]
select = "corner:0,0"
factor = 1
[[collider]]
shape = "capsule"
a = [0, 0, 0]
b = [0, 1, 0]
radius = 1
[wind]
drag = 1
keys = [{ time = 0, velocity = [1, 0, 0] }]
)",
    R"([scene]
format = 1
[[cloth]]
mesh = "garments/tshirt.obj"
rest = { mesh = "garments/tshirt.obj" }
[[cloth.pin]]
select = { sphere = { center = [0, 0, 0], radius = 1 } }
[[collider]]
shape = "box"
half_size = [1, 1, 1]
)",
    R"([scene]
format = 1
[[cloth]]
mesh = "garments/tshirt.obj"
rest = {}
)",
    R"([scene]
format = 1
[[cloth]]
grid = { size = [1, 1], cells = [4, 4] }
[[collider]]
shape = "mesh"
frames = "garments/tshirt*.obj"
)"};

/// The key as a path of overrides in these scenes: "cloth[0].pin[0].pivot".
std::string path_of(const Parameter& p) {
  std::string path, prefix;
  std::istringstream keys(p.key);
  for (std::string key; std::getline(keys, key, '.');) {
    prefix += (prefix.empty() ? "" : ".") + key;
    path += (path.empty() ? "" : ".") + key;
    if (prefix != p.key && find_parameter(prefix).kind == ParameterKind::tables) path += "[0]";
  }
  return path;
}

SceneDesc read(const std::string& scene, const Overrides& overrides = {}) {
  return parse_scene(scene, kRoot / "scenes/test.toml", overrides);
}

bool accepts(const std::string& scene, const Parameter& p, const std::string& value) {
  try {
    read(scene, {path_of(p) + "=" + value});
    return true;
  } catch (const SceneError&) {
    return false;
  }
}

/// The first scene that accepts the value; "" if there is none.
std::string find_scene_for(const Parameter& p, const std::string& value) {
  const auto scene =
      std::find_if(kScenes.begin(), kScenes.end(), [&](const auto& s) { return accepts(s, p, value); });
  return scene == kScenes.end() ? "" : *scene;
}

bool is_whole(const Parameter& p) {
  return p.kind == ParameterKind::whole_number || p.kind == ParameterKind::whole_numbers;
}

/// A number, or an array with this number in every place.
std::string write_value(const Parameter& p, double number) {
  char text[32];
  std::snprintf(text, sizeof text, is_whole(p) ? "%.0f" : "%.17g", number);
  if (p.kind == ParameterKind::number || p.kind == ParameterKind::whole_number) return text;
  std::string list;
  for (int i = 0; i < std::max(p.length, 1); ++i) list += (i > 0 ? ", " : "") + std::string(text);
  return "[" + list + "]";
}

bool has_numbers(const Parameter& p) {
  return is_whole(p) || p.kind == ParameterKind::number || p.kind == ParameterKind::numbers;
}

std::string label(const Parameter& p) { return p.key + (p.form.empty() ? "" : " (" + p.form + ")"); }

std::vector<std::string> sentences_of(const std::string& text) {
  std::vector<std::string> sentences;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(". ", begin), text.size() - 1);
    sentences.push_back(text.substr(begin, end + 1 - begin));
    begin = end + 2;
  }
  return sentences;
}

/// The text in one line: without comment marks, and with the parts of a string literal joined.
std::string flatten(std::istream& in) {
  std::string flat;
  for (std::string line; std::getline(in, line);) {
    const std::size_t begin = line.find_first_not_of(" /#");
    if (begin == std::string::npos) continue;
    line = line.substr(begin);
    std::erase(line, '\\');
    const bool continues = line[0] == '"' && flat.ends_with("\"");
    if (continues) {
      flat.pop_back();
      flat += line.substr(1);
    } else {
      flat += (flat.empty() ? "" : " ") + line;
    }
  }
  return flat;
}

/// Pages of the manual, sources of the library, the programs and the bindings.
std::string read_pages_and_sources() {
  const std::set<std::string> kinds = {".md", ".h", ".cpp", ".py", ".pyi"};
  std::string all;
  for (const char* folder : {"docs/manual", "src", "apps", "python"}) {
    if (!fs::exists(kRoot / folder)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      if (!kinds.contains(entry.path().extension().string())) continue;
      if (entry.path().filename() == "_core.pyi") continue;  // generated from the table
      std::ifstream in(entry.path());
      all += flatten(in) + "\n";
    }
  }
  return all;
}

int count_in(const std::string& text, const std::string& part) {
  int count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(Parameters, HaveOneTextEach) {
  std::set<std::pair<std::string, std::string>> known, described;
  for (const Parameter& p : parameters()) {
    EXPECT_TRUE(known.emplace(p.key, p.form).second) << label(p) << " is in the table twice";
    EXPECT_FALSE(p.description.empty()) << label(p) << ": describe it in parameter_texts.cpp";
  }
  for (const ParameterText& text : parameter_texts()) {
    const auto key = std::pair(std::string(text.key), std::string(text.form));
    EXPECT_TRUE(known.contains(key)) << key.first << ": the reader has no such key, or not in this form";
    EXPECT_TRUE(described.insert(key).second) << key.first << " has two texts";
  }
  EXPECT_GT(known.size(), 100u);
}

TEST(Parameters, HaveShortSentences) {
  for (const Parameter& p : parameters()) {
    if (p.description.empty()) continue;
    EXPECT_TRUE(p.description.ends_with('.')) << label(p) << ": " << p.description;
    EXPECT_EQ(p.description.find('|'), std::string::npos) << label(p) << ": would end the cell of the page";
    for (const std::string& sentence : sentences_of(p.description)) {
      const auto words = std::count(sentence.begin(), sentence.end(), ' ') + 1;
      EXPECT_LE(words, 25) << label(p) << ": " << sentence;
    }
  }
}

TEST(Parameters, HaveNoTextThatIsWrittenTwice) {
  constexpr std::size_t kShort = 30;  // "Higher: slides later." may be right twice
  const std::string all = read_pages_and_sources();
  for (const Parameter& p : parameters()) {
    for (const std::string& sentence : sentences_of(p.description)) {
      if (sentence.size() <= kShort) continue;
      EXPECT_EQ(count_in(all, sentence), 1) << label(p) << ": take it from find_parameter(): " << sentence;
    }
  }
}

TEST(Parameters, HaveTheDefaultsOfTheReader) {
  for (const Parameter& p : parameters()) {
    if (p.default_value.empty()) continue;
    const bool is_default = std::any_of(kScenes.begin(), kScenes.end(), [&](const std::string& scene) {
      if (!accepts(scene, p, p.default_value)) return false;
      SceneDesc without = read(scene), with = read(scene, {path_of(p) + "=" + p.default_value});
      with.cloths[0].has_own_thickness = without.cloths[0].has_own_thickness;
      return with == without;
    });
    EXPECT_TRUE(is_default) << label(p) << " = " << p.default_value;
  }
}

TEST(Parameters, HaveTheLowerLimitsOfTheReader) {
  int count = 0;
  for (const Parameter& p : parameters()) {
    if (!has_numbers(p) || !p.min) continue;
    const double inside = p.excludes_min ? *p.min + 1 : *p.min;
    const double outside = p.excludes_min ? *p.min : *p.min - (is_whole(p) ? 1 : 1e-7);
    const std::string scene = find_scene_for(p, write_value(p, inside));
    ASSERT_NE(scene, "") << label(p) << " cannot be " << inside;
    EXPECT_FALSE(accepts(scene, p, write_value(p, outside))) << label(p) << " = " << outside;
    ++count;
  }
  EXPECT_GT(count, 50);
}

TEST(Parameters, HaveTheUpperLimitsOfTheReader) {
  int count = 0;
  for (const Parameter& p : parameters()) {
    if (!has_numbers(p) || !p.max) continue;
    const std::string scene = find_scene_for(p, write_value(p, *p.max));
    ASSERT_NE(scene, "") << label(p) << " cannot be " << *p.max;
    const double outside = *p.max + (is_whole(p) ? 1 : 1e-6);
    EXPECT_FALSE(accepts(scene, p, write_value(p, outside))) << label(p) << " = " << outside;
    ++count;
  }
  EXPECT_GT(count, 6);
}

TEST(Parameters, HaveTheChoicesOfTheReader) {
  for (const Parameter& p : parameters()) {
    if (p.choices.empty()) continue;
    for (const std::string& choice : p.choices) {
      if (p.key == "collider.shape") continue;  // each needs its own other keys
      EXPECT_NE(find_scene_for(p, choice), "") << label(p) << " = " << choice;
    }
    EXPECT_EQ(find_scene_for(p, "\"none of them\""), "") << label(p);
  }
}

TEST(Parameters, AreFoundByKeyAndForm) {
  EXPECT_EQ(find_parameter("cloth.fabric.damping").unit, "s");
  EXPECT_EQ(find_parameter("cloth.fabric.damping", "springs").unit, "N·s/m");
  EXPECT_TRUE(find_parameter("scene.format").required);
  EXPECT_EQ(find_parameter("cloth.grid").alternatives, std::vector<std::string>{"mesh"});
  const auto message = [](const char* key, const char* form) -> std::string {
    try {
      find_parameter(key, form);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message("solver.iteratons", ""),
            "unknown parameter \"solver.iteratons\"; did you mean \"solver.iterations\"?");
  EXPECT_EQ(message("solver.iterations", "mesh"), "parameter \"solver.iterations\" has no form \"mesh\"");
}

}  // namespace
}  // namespace weft::engine
