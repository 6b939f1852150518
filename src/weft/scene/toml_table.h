#pragma once
/// Private to scene/: typed values from TOML. Mistakes are recorded, and reading continues.
///
///   TomlTable solver = root.table("solver");
///   solver.read("tolerance", settings.tolerance, above_zero("m"));  // keeps the default if missing or wrong

#include <array>
#include <climits>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "weft/core/vec.h"
#include "weft/scene/toml_document.h"

namespace weft::engine {

/// Magnitudes are limited, so that squares neither overflow nor vanish in single precision.
constexpr double kSmallestNumber = 1e-12;  // where it has to be above 0
constexpr double kLargestNumber = 1e12;

/// Range of valid numbers; NaN and infinity are never valid.
struct NumberRule {
  std::string_view unit = "";  // for messages; "" for pure numbers
  enum class Low { none, zero, above_zero } low = Low::none;
  double most = kLargestNumber;
};

constexpr NumberRule any_number(std::string_view unit = "") { return {unit, NumberRule::Low::none}; }
constexpr NumberRule not_negative(std::string_view unit = "") { return {unit, NumberRule::Low::zero}; }
constexpr NumberRule above_zero(std::string_view unit = "") { return {unit, NumberRule::Low::above_zero}; }

struct IntegerRule {
  int least = 0, most = INT_MAX;
};

template <class Choice>
using Choices = std::initializer_list<std::pair<std::string_view, Choice>>;

/// A value, or nothing where a key is missing.
class TomlValue {
 public:
  TomlValue() = default;
  TomlValue(TomlDocument& document, const toml::node& node, std::string name)
      : document_(&document), node_(&node), name_(std::move(name)) {}

  explicit operator bool() const { return node_ != nullptr; }
  bool is_string() const { return node_->is_string(); }
  bool is_boolean() const { return node_->is_boolean(); }
  bool is_table() const { return node_->is_table(); }

  // Each sets the target and returns true; or records a mistake, keeps the target, and returns false.
  bool read(bool& target) const;
  bool read(std::string& target) const;
  bool read(int& target, const IntegerRule& rule) const;
  bool read(double& target, const NumberRule& rule) const;
  bool read(std::span<double> target, const NumberRule& each, std::string_view example) const;
  bool read(Vec3& target, const NumberRule& each, std::string_view example = "[0, 1, 0]") const;
  bool read(std::array<int, 2>& target, const IntegerRule& each) const;
  bool read(std::vector<int>& target, const IntegerRule& each) const;

  /// Sets the target to the choice with the given name.
  template <class Choice>
  bool read_choice(Choice& target, Choices<Choice> choices) const {
    std::vector<std::string> names;
    for (const auto& choice : choices) names.emplace_back(choice.first);
    const int index = find_choice(names);
    if (index >= 0) target = choices.begin()[index].second;
    return index >= 0;
  }

  /// Index of the given name; -1, and a mistake, if it is none of them.
  int find_choice(const std::vector<std::string>& names) const;

  /// An array's elements; empty, and a mistake, if it is not an array.
  std::vector<TomlValue> elements(std::string_view expected) const;

  void mistake(std::string_view message) const;  // "NAME: MESSAGE"
  void expected(std::string_view what) const;    // "NAME: expected WHAT, found …"
  const toml::node& node() const { return *node_; }

 private:
  TomlDocument* document_ = nullptr;
  const toml::node* node_ = nullptr;
  std::string name_;
};

// Documentation of a key by the rules of TomlValue::read(), without a default.
Parameter make_note(const NumberRule& rule);
Parameter make_note(const IntegerRule& rule);
Parameter make_note(const NumberRule& each, int length);  // arrays; length 0: any
Parameter make_note(const IntegerRule& each, int length);

// The same with a default, unless the rule excludes it.
Parameter make_note(const bool& usual);
Parameter make_note(const std::string& usual);
Parameter make_note(const int& usual, const IntegerRule& rule);
Parameter make_note(const double& usual, const NumberRule& rule);
Parameter make_note(std::span<const double> usual, const NumberRule& each, std::string_view example = "");
Parameter make_note(const Vec3& usual, const NumberRule& each, std::string_view example = "");
Parameter make_note(const std::array<int, 2>& usual, const IntegerRule& each);

/// A table that records queried keys. A table that is not in the document can be queried too.
class TomlTable {
 public:
  TomlTable(TomlDocument& document, const toml::table* table, std::string path)
      : document_(&document), section_(&document.add_section(table, std::move(path))) {}

  bool exists() const { return section_->table != nullptr; }
  bool has(std::string_view key) const { return exists() && section_->table->contains(key); }

  TomlValue get(std::string_view key);

  /// Documents a key for parameters(); its `key` and `form` are set here.
  void note(std::string_view key, Parameter note);

  /// The keys that are read next belong to this Parameter::form.
  void set_form(std::string_view form) { section_->form = form; }

  /// note(key, …) and get(key).
  TomlValue get(std::string_view key, Parameter documentation) {
    note(key, std::move(documentation));
    return get(key);
  }

  /// get(key).read(…), false if the key is missing.
  template <class Target, class... Rules>
  bool read(std::string_view key, Target&& target, Rules&&... rules) {
    const TomlValue value = get(key, make_note(target, rules...));
    return value && value.read(std::forward<Target>(target), std::forward<Rules>(rules)...);
  }

  template <class Choice>
  bool read_choice(std::string_view key, Choice& target, Choices<Choice> choices) {
    Parameter note{.kind = ParameterKind::choice};
    for (const auto& [name, choice] : choices) {
      note.choices.push_back(quote(name));
      if (choice == target) note.default_value = note.choices.back();
    }
    const TomlValue value = get(key, std::move(note));
    return value && value.read_choice(target, choices);
  }

  /// Index of the given name; -1 if the key is missing or its value, a mistake, is none of the names.
  int find_choice(std::string_view key, const std::vector<std::string>& names, std::string_view usual = "");

  TomlTable table(std::string_view key);

  /// The tables of an array, written [[key]] or key = [{ … }, …].
  std::vector<TomlTable> tables(std::string_view key);

  /// A table that is an element of some array, to be read like one of tables(key).
  TomlTable element(std::string_view key, const TomlValue& element);

  /// At least one of the keys must be present (a mistake if not, unless one of them is misspelt).
  void require_any(std::initializer_list<std::string_view> keys, std::string_view expected);

  /// Exactly one of the keys must be present (a mistake if not, unless one of them is misspelt).
  void require(std::initializer_list<std::string_view> one_of, std::string_view expected);

  /// Records a mistake if the key is present.
  void refuse(std::string_view key, std::string_view why);

  /// Allows unknown keys.
  void allow_any_keys() { section_->any_keys = true; }

 private:
  std::string path_of(std::string_view key) const;

  TomlDocument* document_;
  TomlSection* section_;
};

}  // namespace weft::engine
