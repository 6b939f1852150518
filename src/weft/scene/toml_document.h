#pragma once
/// Private to scene/: a TOML text, what is asked of it, and every mistake found. Knows nothing of scenes.

#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "weft/scene/diagnostic.h"
#include "weft/scene/toml_plus_plus.h"

namespace weft::engine {

/// What a key may hold, in words: for the reference of scene files.
struct KeyNote {
  std::string key;
  std::string holds;  // "number > 0"
  std::string unit;   // "m"; empty: none
  std::string usual;  // the default, as it would be written; empty: none
};

/// What a reader asked one table for. Keys that nobody asked for are mistakes; only at the end is it known
/// which.
struct TomlSection {
  struct Requirement {
    std::vector<std::string> one_of;  // keys
    std::string expected;             // for the message
  };

  const toml::table* table =
      nullptr;                    // nullptr: not in the document; asked all the same, so that keys are known
  std::string path;               // "cloth.fabric"; empty: the document
  std::vector<std::string> keys;  // known ones, in the order of asking
  std::vector<std::string> refused;  // keys that were reported already
  std::vector<Requirement> required;
  bool any_keys = false;       // unknown keys are not judged
  std::vector<KeyNote> notes;  // of keys that were asked for by what they may hold
};

class TomlDocument {
 public:
  /// Throws SceneError with one diagnostic if the text is not TOML.
  TomlDocument(std::string_view text, std::string file);

  /// "path.to.key=value" or "list[2].key=value": replaces or adds a value, which is TOML or else taken as a
  /// string. What cannot be followed is recorded as a mistake.
  void override_value(const std::string& assignment);

  const toml::table& root() const { return root_; }

  const std::deque<TomlSection>& sections() const { return sections_; }

  TomlSection& add_section(const toml::table* table, std::string path);
  void add_mistake(const toml::source_region& place, std::string message);

  /// Judges unknown and missing keys, and hands over all mistakes in the order of their places, overrides
  /// last.
  std::vector<Diagnostic> finish();

 private:
  void judge(const TomlSection& section);
  std::string explain_unknown(const TomlSection& section, const std::string& key,
                              const toml::source_region& place) const;
  const TomlSection* find_home(const TomlSection& section, std::string_view key) const;
  bool is_override(const toml::source_region& place) const;

  std::string file_;
  toml::table root_;
  std::deque<TomlSection> sections_;
  std::vector<Diagnostic> mistakes_;
};

/// Parses text; `source` is the file in messages. Throws SceneError. Refuses what is nested so deeply that
/// toml++, which destroys tables recursively, would run out of stack.
toml::table parse_toml(std::string_view text, const std::string& source);

/// In quotes, shortened to so many bytes, and without control characters that would upset a terminal.
std::string quote(std::string_view text, std::size_t max_length = 60);

}  // namespace weft::engine
