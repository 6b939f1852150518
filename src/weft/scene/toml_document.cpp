#include "weft/scene/toml_document.h"

#include <algorithm>
#include <tuple>

#include "weft/core/nearest_name.h"

namespace weft::engine {
namespace {

bool contains(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string join(const std::vector<std::string>& names, const char* separator) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : separator) + name;
  return text;
}

/// "cloth" of "cloth.fabric", "" of "cloth".
std::string parent(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string::npos ? "" : path.substr(0, dot);
}

bool is_top_level(const std::string& path) { return path.find('.') == std::string::npos; }

}  // namespace

TomlDocument::TomlDocument(std::string_view text, std::string file)
    : file_(std::move(file)), root_(parse_toml(text, file_)) {}

TomlSection& TomlDocument::add_section(const toml::table* table, std::string path) {
  TomlSection& section = sections_.emplace_back();
  section.table = table;
  section.path = std::move(path);
  return section;
}

bool TomlDocument::is_override(const toml::source_region& place) const {
  return place.path && *place.path != file_;
}

void TomlDocument::add_mistake(const toml::source_region& place, std::string message) {
  if (is_override(place)) {
    mistakes_.push_back({*place.path, 0, 0, std::move(message)});
  } else {
    const auto [line, column] = place.begin;
    mistakes_.push_back({file_, static_cast<int>(line), static_cast<int>(column), std::move(message)});
  }
}

std::vector<Diagnostic> TomlDocument::finish() {
  for (const TomlSection& section : sections_) check(section);
  const auto order = [](const Diagnostic& d) { return std::tuple(d.line == 0, d.line, d.column); };
  std::stable_sort(mistakes_.begin(), mistakes_.end(),
                   [&](const Diagnostic& a, const Diagnostic& b) { return order(a) < order(b); });
  return std::move(mistakes_);
}

void TomlDocument::check(const TomlSection& section) {
  if (!section.table) return;
  std::vector<std::string> meant;  // by misspelt keys; these are not reported as missing too
  for (const auto& [key, value] : *section.table) {
    const std::string name(key.str());
    if (section.any_keys || contains(section.keys, name) || contains(section.refused, name)) continue;
    meant.push_back(find_nearest(name, section.keys));
    add_mistake(key.source(), explain_unknown(section, name, key.source()));
  }
  for (const auto& [one_of, expected] : section.required) {
    const bool is_there = std::any_of(one_of.begin(), one_of.end(), [&](const std::string& key) {
      return section.table->contains(key) || contains(meant, key);
    });
    const std::string keys = "\"" + join(one_of, "\" or \"") + "\"";
    if (!is_there) add_mistake(section.table->source(), "missing key " + keys + ", expected " + expected);
  }
}

std::string TomlDocument::explain_unknown(const TomlSection& section, const std::string& key,
                                          const toml::source_region& place) const {
  const std::string unknown = "unknown key " + quote(key);
  const std::string nearest = find_nearest(key, section.keys);
  if (!nearest.empty()) return unknown + "; did you mean " + quote(nearest) + "?";
  if (const TomlSection* home = find_home(section, key)) {
    // An override without its leading sections, "paper.damping_sign=…": suggest the full path.
    const bool starts_too_low = is_override(place) && section.path.empty();
    const std::string rest = starts_too_low ? place.path->substr(place.path->find(' ') + 1) : key;
    return unknown + "; did you mean " + (home->path.empty() ? "" : home->path + ".") + rest + "?";
  }
  return unknown + "; known here: " + join(section.keys, ", ");
}

/// The section that has the key, among the top-level ones, the parent and the children.
const TomlSection* TomlDocument::find_home(const TomlSection& section, std::string_view key) const {
  for (const TomlSection& other : sections_) {
    const bool is_near =
        is_top_level(other.path) || parent(other.path) == section.path || parent(section.path) == other.path;
    if (is_near && other.path != section.path && contains(other.keys, key)) return &other;
  }
  return nullptr;
}

std::string quote(std::string_view text, std::size_t max_length) {
  std::size_t length = std::min(text.size(), max_length);
  // UTF-8: never cuts between the bytes of one character.
  while (length < text.size() && length > 0 && (static_cast<unsigned char>(text[length]) & 0xC0) == 0x80)
    --length;
  std::string quoted = "\"" + std::string(text.substr(0, length));
  for (char& c : quoted) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  }
  return quoted + (length < text.size() ? "…\"" : "\"");
}

}  // namespace weft::engine
