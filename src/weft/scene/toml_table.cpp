#include "weft/scene/toml_table.h"

#include <algorithm>
#include <cstdio>

namespace weft::engine {

namespace {

/// A number as in a scene file, rounded for readers.
std::string write_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string limits_of(const NumberRule& rule) {
  std::string limits;
  if (rule.low == NumberRule::Low::zero) limits = " ≥ 0";
  if (rule.low == NumberRule::Low::above_zero) limits = " > 0";
  if (rule.most < kLargestNumber) limits += " ≤ " + write_number(rule.most);
  return limits;
}

std::string limits_of(const IntegerRule& rule) {
  return " ≥ " + std::to_string(rule.least) + (rule.most < INT_MAX ? " ≤ " + std::to_string(rule.most) : "");
}

}  // namespace

KeyNote make_note(std::string_view key, const bool& usual) {
  return {std::string(key), "true or false", "", usual ? "true" : "false"};
}

KeyNote make_note(std::string_view key, const std::string& usual) {
  return {std::string(key), "text", "", usual.empty() ? "" : quote(usual)};
}

KeyNote make_note(std::string_view key, const int& usual, const IntegerRule& rule) {
  return {std::string(key), "whole number" + limits_of(rule), "", std::to_string(usual)};
}

KeyNote make_note(std::string_view key, const double& usual, const NumberRule& rule) {
  return {std::string(key), "number" + limits_of(rule), std::string(rule.unit), write_number(usual)};
}

KeyNote make_note(std::string_view key, std::span<const double> usual, const NumberRule& each,
                  std::string_view) {
  std::string list;
  for (const double value : usual) list += (list.empty() ? "[" : ", ") + write_number(value);
  return {std::string(key), std::to_string(usual.size()) + " numbers" + limits_of(each),
          std::string(each.unit), list + "]"};
}

KeyNote make_note(std::string_view key, const Vec3& usual, const NumberRule& each, std::string_view example) {
  return make_note(key, std::span<const double>(usual.data(), 3), each, example);
}

KeyNote make_note(std::string_view key, const std::array<int, 2>&, const IntegerRule& each) {
  return {std::string(key), "2 whole numbers" + limits_of(each), "", ""};
}

TomlValue TomlTable::get(std::string_view key) {
  std::vector<std::string>& keys = section_->keys;
  if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.emplace_back(key);
  if (!has(key)) return {};
  return {*document_, *section_->table->get(key), std::string(key)};
}

std::string TomlTable::path_of(std::string_view key) const {
  return section_->path + (section_->path.empty() ? "" : ".") + std::string(key);
}

TomlTable TomlTable::table(std::string_view key) {
  const TomlValue value = get(key);
  if (value && !value.is_table()) value.expected("a table");
  return {*document_, value ? value.node().as_table() : nullptr, path_of(key)};
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) {
  std::vector<TomlTable> tables;
  const TomlValue value = get(key);
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

void TomlTable::require(std::initializer_list<std::string_view> one_of, std::string_view expected) {
  section_->required.push_back({{one_of.begin(), one_of.end()}, std::string(expected)});
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
