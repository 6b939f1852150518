#include <charconv>
#include <optional>

#include "weft/scene/toml_document.h"

namespace weft::engine {
namespace {

std::string trim(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(' '), end = text.find_last_not_of(' ');
  return begin == std::string::npos ? "" : text.substr(begin, end - begin + 1);
}

/// One component of a path: "key" or "key[2]".
struct Step {
  std::string key;
  std::vector<std::size_t> indices;
};

bool is_key_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

/// Takes "[2]" off the front of the text.
std::optional<std::size_t> take_index(std::string_view& text) {
  std::size_t index = 0;
  if (text.empty() || text[0] != '[') return {};
  const auto [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), index);
  if (error != std::errc() || end == text.data() + text.size() || *end != ']') return {};
  text.remove_prefix(static_cast<std::size_t>(end - text.data()) + 1);
  return index;
}

/// Takes "key[2]" off the front of the text.
std::optional<Step> take_step(std::string_view& text) {
  Step step;
  while (!text.empty() && is_key_character(text[0])) {
    step.key += text[0];
    text.remove_prefix(1);
  }
  while (const auto index = take_index(text)) step.indices.push_back(*index);
  if (step.key.empty()) return {};
  return step;
}

std::optional<std::vector<Step>> parse_path(std::string_view path) {
  constexpr std::size_t kMaxSteps = 16;
  std::vector<Step> steps;
  while (steps.size() < kMaxSteps) {
    const std::optional<Step> step = take_step(path);
    if (!step) return {};
    steps.push_back(*step);
    if (path.empty()) return steps;
    if (path[0] != '.') return {};
    path.remove_prefix(1);
  }
  return {};
}

std::string as_toml_string(std::string_view text) {
  static constexpr char kHex[] = "0123456789abcdef";
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F) {
      quoted += std::string("\\u00") + kHex[byte >> 4] + kHex[byte & 15];
    } else {
      quoted += (c == '"' || c == '\\' ? "\\" : "") + std::string(1, c);
    }
  }
  return quoted + "\"";
}

/// A table with one value, "value", whose source is `source`.
toml::table parse_value(std::string_view text, const std::string& source) {
  try {
    toml::table table = parse_toml("value = " + std::string(text), source);
    if (table.size() == 1) return table;
  } catch (const SceneError&) {
  }
  return parse_toml("value = " + as_toml_string(text), source);
}

/// Follows the path and sets the value at its end. Returns the mistake, "" if none.
class Walk {
 public:
  Walk(toml::table& root, toml::table value) : at_(&root), value_(std::move(value)) {}

  std::string follow(const std::vector<Step>& steps) {
    for (std::size_t s = 0; s < steps.size(); ++s) {
      const bool is_last = s + 1 == steps.size();
      const std::string mistake = step(steps[s], is_last);
      if (!mistake.empty()) return mistake;
    }
    return "";
  }

 private:
  std::string step(const Step& step, bool is_last) {
    walked_ += (walked_.empty() ? "" : ".") + step.key;
    toml::table& table = *at_->as_table();
    if (step.indices.empty()) return is_last ? put(table, step.key) : enter(table, step.key);
    at_ = table.get(step.key);
    if (!at_) return "there is no list " + walked_;
    for (std::size_t i = 0; i < step.indices.size(); ++i) {
      const bool is_end = is_last && i + 1 == step.indices.size();
      const std::string mistake = choose(step.indices[i], is_end);
      if (!mistake.empty()) return mistake;
    }
    return is_last || at_->is_table() ? "" : walked_ + " is not a table";
  }

  toml::node&& take_value() { return std::move(*value_.get("value")); }

  std::string put(toml::table& table, const std::string& key) {
    table.insert_or_assign(toml::key(key, value_.get("value")->source()), take_value());
    return "";
  }

  std::string enter(toml::table& table, const std::string& key) {
    at_ = table.get(key);
    if (!at_) {
      // An empty table that has a source.
      toml::table created = parse_toml("value = {}", *value_.get("value")->source().path);
      const toml::source_region source = value_.get("value")->source();
      at_ = &table.insert_or_assign(toml::key(key, source), std::move(*created.get("value"))).first->second;
    }
    if (at_->is_table()) return "";
    return walked_ +
           (at_->is_array() ? " is a list; give an index, as in " + walked_ + "[0]" : " is not a table");
  }

  std::string choose(std::size_t index, bool is_end) {
    toml::array* list = at_->as_array();
    if (!list) return walked_ + " is not a list";
    if (index >= list->size()) {
      return "there is no " + walked_ + "[" + std::to_string(index) + "], the list has " +
             std::to_string(list->size());
    }
    walked_ += "[" + std::to_string(index) + "]";
    if (is_end) list->replace(list->cbegin() + static_cast<std::ptrdiff_t>(index), take_value());
    at_ = list->get(index);
    return "";
  }

  toml::node* at_;
  toml::table value_;
  std::string walked_;
};

}  // namespace

void TomlDocument::override_value(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  const std::string path = trim(assignment.substr(0, equals)), source = "--set " + path;
  const std::optional<std::vector<Step>> steps = parse_path(path);
  if (equals == std::string::npos || !steps) {
    mistakes_.push_back({source, 0, 0, "expected path.to.key=value or list[0].key=value"});
    return;
  }
  try {
    const std::string mistake =
        Walk(root_, parse_value(assignment.substr(equals + 1), source)).follow(*steps);
    if (!mistake.empty()) mistakes_.push_back({source, 0, 0, mistake});
  } catch (const SceneError& error) {
    mistakes_.push_back({source, 0, 0, error.diagnostics().front().message});
  }
}

}  // namespace weft::engine
