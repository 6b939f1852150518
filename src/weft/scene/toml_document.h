#pragma once
/// Private to scene/: a TOML text, the queries of its readers, and the mistakes found. Independent of scenes.

#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "weft/parameters.h"
#include "weft/scene.h"
#include "weft/scene/toml_plus_plus.h"

namespace weft::engine {

/// Keys that a reader queries in one table. Keys that were never queried are mistakes, found in finish().
struct TomlSection {
  struct Requirement {
    std::vector<std::string> one_of;  // keys
    std::string expected;             // for the message
  };

  const toml::table* table = nullptr;  // nullptr: not in the document; its keys are recorded all the same
  std::string path;                    // "cloth.fabric"; empty: the document
  std::vector<std::string> keys;       // known ones, in the order of queries
  std::vector<std::string> refused;    // keys that have already been reported
  std::vector<Requirement> required;
  bool any_keys = false;         // unknown keys are allowed
  std::string form;              // Parameter::form of the keys that are read next
  std::vector<Parameter> notes;  // documentation of the keys; their `key` is without the path
};

class TomlDocument {
 public:
  /// Throws SceneError with one diagnostic if the text is not TOML.
  TomlDocument(std::string_view text, std::string file);

  /// "path.to.key=value" or "list[2].key=value": replaces or adds a value, which is TOML or else a string. A
  /// path that does not fit the document is recorded as a mistake.
  void override_value(const std::string& assignment);

  const toml::table& root() const { return root_; }

  const std::deque<TomlSection>& sections() const { return sections_; }

  TomlSection& add_section(const toml::table* table, std::string path);
  void add_mistake(const toml::source_region& place, std::string message);

  /// Checks for unknown and missing keys, and returns all mistakes in the order of the text, overrides last.
  std::vector<Diagnostic> finish();

 private:
  void check(const TomlSection& section);
  std::string explain_unknown(const TomlSection& section, const std::string& key,
                              const toml::source_region& place) const;
  const TomlSection* find_home(const TomlSection& section, std::string_view key) const;
  bool is_override(const toml::source_region& place) const;

  std::string file_;
  toml::table root_;
  std::deque<TomlSection> sections_;
  std::vector<Diagnostic> mistakes_;
};

/// Parses text; `source` is the file in messages. Throws SceneError, also where nesting is so deep that
/// toml++, which destroys tables recursively, would run out of stack.
toml::table parse_toml(std::string_view text, const std::string& source);

/// The text in quotes, at most `max_length` bytes, with control characters replaced for terminals.
std::string quote(std::string_view text, std::size_t max_length = 60);

}  // namespace weft::engine
