#include "weft/scene/toml_table.h"

#include <algorithm>
#include <climits>
#include <cstdio>

namespace weft::engine {

namespace {

/// A number as in a scene file, rounded for readers.
std::string write_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

bool allows(double number, const NumberRule& rule) {
  return rule.low == NumberRule::Low::none || number > 0 ||
         (rule.low == NumberRule::Low::zero && number == 0);
}

bool allows(int number, const IntegerRule& rule) { return number >= rule.least && number <= rule.most; }

}  // namespace

Parameter make_note(const NumberRule& rule) {
  Parameter note{.kind = ParameterKind::number, .unit = std::string(rule.unit)};
  if (rule.low != NumberRule::Low::none) note.min = 0;
  note.excludes_min = rule.low == NumberRule::Low::above_zero;
  if (rule.most < kLargestNumber) note.max = rule.most;
  return note;
}

Parameter make_note(const IntegerRule& rule) {
  Parameter note{.kind = ParameterKind::whole_number, .min = rule.least};
  if (rule.most < INT_MAX) note.max = rule.most;
  return note;
}

Parameter make_note(const NumberRule& each, int length) {
  Parameter note = make_note(each);
  note.kind = ParameterKind::numbers;
  note.length = length;
  return note;
}

Parameter make_note(const IntegerRule& each, int length) {
  Parameter note = make_note(each);
  note.kind = ParameterKind::whole_numbers;
  note.length = length;
  return note;
}

Parameter make_note(const bool& usual) {
  return {.kind = ParameterKind::flag, .default_value = usual ? "true" : "false"};
}

Parameter make_note(const std::string& usual) {
  return {.kind = ParameterKind::text, .default_value = usual.empty() ? "" : quote(usual)};
}

Parameter make_note(const int& usual, const IntegerRule& rule) {
  Parameter note = make_note(rule);
  if (allows(usual, rule)) note.default_value = std::to_string(usual);
  return note;
}

Parameter make_note(const double& usual, const NumberRule& rule) {
  Parameter note = make_note(rule);
  if (allows(usual, rule)) note.default_value = write_number(usual);
  return note;
}

Parameter make_note(std::span<const double> usual, const NumberRule& each, std::string_view) {
  Parameter note = make_note(each, static_cast<int>(usual.size()));
  std::string list;
  for (const double value : usual) {
    if (!allows(value, each)) return note;
    list += (list.empty() ? "[" : ", ") + write_number(value);
  }
  note.default_value = list + "]";
  return note;
}

Parameter make_note(const Vec3& usual, const NumberRule& each, std::string_view example) {
  return make_note(std::span<const double>(usual.data(), 3), each, example);
}

Parameter make_note(const std::array<int, 2>& usual, const IntegerRule& each) {
  return make_note(each, static_cast<int>(usual.size()));
}

TomlValue TomlTable::get(std::string_view key) {
  std::vector<std::string>& keys = section_->keys;
  if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.emplace_back(key);
  if (!has(key)) return {};
  return {*document_, *section_->table->get(key), std::string(key)};
}

void TomlTable::note(std::string_view key, Parameter note) {
  note.key = key;
  note.form = section_->form;
  section_->notes.push_back(std::move(note));
}

int TomlTable::find_choice(std::string_view key, const std::vector<std::string>& names,
                           std::string_view usual) {
  Parameter note{.kind = ParameterKind::choice, .default_value = usual.empty() ? "" : quote(usual)};
  for (const std::string& name : names) note.choices.push_back(quote(name));
  const TomlValue value = get(key, std::move(note));
  return value ? value.find_choice(names) : -1;
}

std::string TomlTable::path_of(std::string_view key) const {
  return section_->path + (section_->path.empty() ? "" : ".") + std::string(key);
}

TomlTable TomlTable::table(std::string_view key) {
  const TomlValue value = get(key, {.kind = ParameterKind::table});
  if (value && !value.is_table()) value.expected("a table");
  return {*document_, value ? value.node().as_table() : nullptr, path_of(key)};
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) {
  std::vector<TomlTable> tables;
  const TomlValue value = get(key, {.kind = ParameterKind::tables});
  if (!value) return tables;
  const std::string path = path_of(key), expected = "an array of tables, written [[" + path + "]]";
  if (value.is_table()) {
    value.expected(expected);
    tables.emplace_back(*document_, value.node().as_table(), path);
    return tables;
  }
  for (const TomlValue& element : value.elements(expected)) {
    if (!element.is_table()) element.expected("a table");
    if (element.is_table()) tables.emplace_back(*document_, element.node().as_table(), path);
  }
  return tables;
}

TomlTable TomlTable::element(std::string_view key, const TomlValue& element) {
  return {*document_, element.node().as_table(), path_of(key)};
}

void TomlTable::require_any(std::initializer_list<std::string_view> keys, std::string_view expected) {
  section_->required.push_back({{keys.begin(), keys.end()}, std::string(expected)});
}

void TomlTable::require(std::initializer_list<std::string_view> one_of, std::string_view expected) {
  require_any(one_of, expected);
  // Of several, the mistake is at the key that comes later in the file.
  const toml::key* first = nullptr;
  for (const std::string_view name : one_of) {
    if (!has(name)) continue;
    const toml::key* key = &section_->table->find(name)->first;
    if (first) {
      const bool in_order = first->source().begin < key->source().begin;
      const toml::key *early = in_order ? first : key, *late = in_order ? key : first;
      document_->add_mistake(late->source(), std::string(late->str()) + ": cannot be combined with " +
                                                 quote(early->str()) + "; remove one");
    }
    first = key;
  }
}

void TomlTable::refuse(std::string_view key, std::string_view why) {
  if (!has(key)) return;
  section_->refused.emplace_back(key);
  document_->add_mistake(section_->table->find(key)->first.source(),
                         std::string(key) + ": " + std::string(why));
}

}  // namespace weft::engine
