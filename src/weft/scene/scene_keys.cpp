/// The reference of scene files, from what the reader asks for.

#include <algorithm>
#include <map>

#include "weft/scene/scene_reader.h"
#include "weft/scene/scene_sections.h"

namespace weft::engine {
namespace {

/// Files that between them make the reader ask for every key it knows; they need not be good scenes.
constexpr std::string_view kKeySamples[] = {
    R"([scene]
[[cloth]]
grid = {}
[cloth.fabric]
spring_structural = 1
[[cloth.pin]]
select = { box = {} }
motion = [{}]
[[cloth.stiffen]]
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
[[contact]]
[wind]
keys = [{}]
)",
    R"([scene]
[[cloth]]
mesh = "file.obj"
[cloth.fabric]
c11 = 1
[[cloth.pin]]
select = { sphere = {} }
)"};

/// Keys of all tables by their paths, both in the order of asking.
class KeyTable {
 public:
  void add(const TomlSection& section) {
    for (const std::string& key : section.keys) note_of(section.path, key);
    for (const KeyNote& note : section.notes) {
      KeyNote& known = note_of(section.path, note.key);
      if (known.holds.empty()) known = note;
    }
    for (const TomlSection::Requirement& r : section.required) {
      for (const std::string& key : r.one_of) required_[section.path + "." + key] = words_for(r.one_of);
    }
  }

  std::string to_markdown() const {
    std::string text;
    for (const auto& [path, notes] : tables_) {
      text += "## " + (path.empty() ? "The file" : "`" + path + "`") +
              "\n\n| key | holds | unit | default |\n|---|---|---|---|\n";
      for (const KeyNote& n : notes) {
        text += "| `" + n.key + "` | " + words_about(path, n) + " | " + n.unit + " | " + default_of(path, n) +
                " |\n";
      }
      text += "\n";
    }
    return text;
  }

 private:
  static std::string words_for(const std::vector<std::string>& one_of) {
    if (one_of.size() == 1) return "required";
    std::string words;
    for (const std::string& key : one_of) words += (words.empty() ? "one of `" : ", `") + key + "`";
    return words;
  }

  std::string words_about(const std::string& path, const KeyNote& note) const {
    if (!note.holds.empty()) return note.holds;
    const std::string own = path.empty() ? note.key : path + "." + note.key;
    const bool has_table =
        std::any_of(tables_.begin(), tables_.end(), [&](const auto& t) { return t.first == own; });
    return has_table ? "see `" + own + "` below" : "see [the manual](scenes.md)";
  }

  std::string default_of(const std::string& path, const KeyNote& note) const {
    const auto required = required_.find(path + "." + note.key);
    return required == required_.end() ? note.usual : required->second;
  }

  KeyNote& note_of(const std::string& path, const std::string& key) {
    const auto table =
        std::find_if(tables_.begin(), tables_.end(), [&](const auto& t) { return t.first == path; });
    auto& notes =
        table == tables_.end() ? tables_.emplace_back(path, std::vector<KeyNote>{}).second : table->second;
    const auto note =
        std::find_if(notes.begin(), notes.end(), [&](const KeyNote& n) { return n.key == key; });
    return note == notes.end() ? notes.emplace_back(KeyNote{.key = key}) : *note;
  }

  std::vector<std::pair<std::string, std::vector<KeyNote>>> tables_;
  std::map<std::string, std::string> required_;  // by path, and in which words
};

}  // namespace

std::string describe_scene_keys() {
  KeyTable table;
  for (const std::string_view sample : kKeySamples) {
    TomlDocument document(sample, "sample");
    read_document(document, "sample");
    for (const TomlSection& section : document.sections()) table.add(section);
  }
  return "# Every key of a scene file\n\nWritten by `weft check --keys` from what the reader asks a file "
         "for. "
         "[scenes.md](scenes.md) says what they mean.\n\n" +
         table.to_markdown();
}

}  // namespace weft::engine
