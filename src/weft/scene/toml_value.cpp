#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "weft/core/nearest_name.h"
#include "weft/scene/toml_table.h"

namespace weft::engine {
namespace {

/// Shortest text that does not read as an integer.
std::string to_text(double number) {
  char buffer[32];
  const std::string text(buffer, std::to_chars(buffer, buffer + sizeof buffer, number).ptr);
  return text.find_first_not_of("-0123456789") == std::string::npos ? text + ".0" : text;
}

/// The value as a double; integers may lose precision.
std::optional<double> to_number(const toml::node& node) {
  if (const auto* number = node.as_floating_point()) return number->get();
  if (const auto* integer = node.as_integer()) return static_cast<double>(integer->get());
  return {};
}

std::string describe_array(const toml::array& array) {
  if (array.empty()) return "an empty array";
  return "an array of " + std::to_string(array.size()) + (array.size() == 1 ? " value" : " values");
}

std::string describe(const toml::node& node) {
  if (const auto* text = node.as_string()) return "the string " + quote(text->get());
  if (const auto* integer = node.as_integer()) return "the number " + std::to_string(integer->get());
  if (const auto* number = node.as_floating_point()) return "the number " + to_text(number->get());
  if (const auto* boolean = node.as_boolean()) return boolean->get() ? "true" : "false";
  if (const auto* array = node.as_array()) return describe_array(*array);
  return node.is_table() ? "a table" : "a date or time";
}

bool is_limited(const NumberRule& rule) { return rule.most < kLargestNumber; }

std::string describe(const NumberRule& rule) {
  std::string text = "a number";
  if (rule.low == NumberRule::Low::above_zero) text += " above 0";
  if (rule.low == NumberRule::Low::zero) {
    text += is_limited(rule) ? " from 0 to " + to_text(rule.most) : " not below 0";
  }
  return text + (rule.unit.empty() ? "" : " in " + std::string(rule.unit));
}

std::string describe(const IntegerRule& rule) {
  const std::string least = std::to_string(rule.least);
  if (rule.most == INT_MAX) return "a whole number, at least " + least;
  return "a whole number from " + least + " to " + std::to_string(rule.most);
}

bool obeys(double number, const NumberRule& rule) {
  if (rule.low == NumberRule::Low::zero && number < 0) return false;
  if (rule.low == NumberRule::Low::above_zero && number <= 0) return false;
  return number <= rule.most || !is_limited(rule);
}

/// Whether the magnitude fits single precision.
bool has_fit_magnitude(double number, const NumberRule& rule) {
  const bool too_small = rule.low == NumberRule::Low::above_zero && number < kSmallestNumber;
  return std::abs(number) <= kLargestNumber && !too_small;
}

/// "; …" if the text is a number with quotes or a unit around it.
std::string hint_at_unit(const toml::node& node) {
  const auto* text = node.as_string();
  double number = 0;
  if (!text) return "";
  const std::string& s = text->get();
  const bool is_number = std::from_chars(s.data(), s.data() + s.size(), number).ec == std::errc();
  return is_number ? "; values are plain numbers in SI units, without unit and quotes" : "";
}

}  // namespace

void TomlValue::mistake(std::string_view message) const {
  document_->add_mistake(node_->source(), name_ + ": " + std::string(message));
}

void TomlValue::expected(std::string_view what) const {
  mistake("expected " + std::string(what) + ", found " + describe(*node_));
}

bool TomlValue::read(bool& target) const {
  const auto* boolean = node_->as_boolean();
  if (!boolean) return expected("true or false"), false;
  target = boolean->get();
  return true;
}

bool TomlValue::read(std::string& target) const {
  const auto* text = node_->as_string();
  if (!text) return expected("a string"), false;
  target = text->get();
  return true;
}

bool TomlValue::read(int& target, const IntegerRule& rule) const {
  const auto* integer = node_->as_integer();
  const bool is_right = integer && integer->get() >= rule.least && integer->get() <= rule.most;
  if (!is_right) return expected(describe(rule)), false;
  target = static_cast<int>(integer->get());
  return true;
}

bool TomlValue::read(double& target, const NumberRule& rule) const {
  const std::optional<double> number = to_number(*node_);
  if (!number) {
    mistake("expected " + describe(rule) + ", found " + describe(*node_) + hint_at_unit(*node_));
  } else if (!std::isfinite(*number) || !obeys(*number, rule)) {
    expected(describe(rule));
  } else if (!has_fit_magnitude(*number, rule)) {
    expected(*number > 0 && *number < 1 ? "a number of at least 1e-12"
                                        : "a number of at most 1e12 in magnitude");
  } else {
    target = *number;
    return true;
  }
  return false;
}

bool TomlValue::read(std::span<double> target, const NumberRule& each, std::string_view example) const {
  const toml::array* array = node_->as_array();
  if (!array || array->size() != target.size()) {
    const std::string unit = each.unit.empty() ? "" : " in " + std::string(each.unit);
    expected(std::to_string(target.size()) + " numbers" + unit + ", as in " + std::string(example));
    return false;
  }
  std::vector<double> numbers(target.size());
  bool is_right = true;
  const std::vector<TomlValue> values = elements("");
  for (std::size_t i = 0; i < numbers.size(); ++i) is_right &= values[i].read(numbers[i], each);
  if (is_right) std::copy(numbers.begin(), numbers.end(), target.begin());
  return is_right;
}

bool TomlValue::read(Vec3& target, const NumberRule& each, std::string_view example) const {
  return read(std::span<double>(target.data(), 3), each, example);
}

bool TomlValue::read(std::array<int, 2>& target, const IntegerRule& each) const {
  const toml::array* array = node_->as_array();
  if (!array || array->size() != 2) return expected("2 whole numbers, as in [32, 32]"), false;
  std::vector<int> numbers;
  if (!read(numbers, each)) return false;
  target = {numbers[0], numbers[1]};
  return true;
}

bool TomlValue::read(std::vector<int>& target, const IntegerRule& each) const {
  std::vector<int> numbers;
  bool is_right = node_->is_array();
  for (const TomlValue& element : elements("an array of whole numbers, as in [1, 2]")) {
    is_right &= element.read(numbers.emplace_back(), each);
  }
  if (is_right) target = std::move(numbers);
  return is_right;
}

int TomlValue::find_choice(const std::vector<std::string>& names) const {
  const auto* text = node_->as_string();
  const auto found = std::find(names.begin(), names.end(), text ? text->get() : "");
  if (found != names.end()) return static_cast<int>(found - names.begin());
  std::string list;
  for (const std::string& name : names) {
    list += (list.empty() ? "" : names.back() == name ? " or " : ", ") + quote(name);
  }
  const std::string nearest = text ? find_nearest(text->get(), names) : "";
  const std::string hint = nearest.empty() ? "" : "; did you mean " + quote(nearest) + "?";
  mistake("expected " + list + ", found " + describe(*node_) + hint);
  return -1;
}

std::vector<TomlValue> TomlValue::elements(std::string_view what) const {
  std::vector<TomlValue> values;
  const toml::array* array = node_->as_array();
  if (!array) return expected(what), values;
  for (std::size_t i = 0; i < array->size(); ++i) {
    values.emplace_back(*document_, *array->get(i), name_ + "[" + std::to_string(i) + "]");
  }
  return values;
}

}  // namespace weft::engine
