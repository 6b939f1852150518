#pragma once
/// Table of the parameters: the keys of scene files with unit, range, default and meaning. Link weft::scene.
///
/// docs/reference/scene_keys.md and the window's explanations are generated from it. The texts exist nowhere
/// else; panels and bindings take them from here.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "weft/export.h"

namespace weft {

/// Type of a parameter's value.
enum class ParameterKind {
  flag,           // true or false
  number,         // or one of `choices`
  whole_number,   // or one of `choices`
  text,           // a string
  file,           // a string: name of a file, relative to the scene file
  choice,         // one of `choices`
  numbers,        // an array of `length`
  whole_numbers,  // an array of `length`
  texts,          // an array of strings, of `length`
  pairs,          // an array of pairs of numbers
  table,          // its keys are parameters too
  tables,         // an array of tables, [[key]] in scene files
};

struct Parameter {
  std::string key = {};  // path in scene files, without indices: "cloth.fabric.c11"

  /// Variant of the table to which the parameter belongs; empty: all. Of `collider` the shape ("sphere"), of
  /// `cloth` "grid" or "mesh", of `cloth.fabric` "fabric" (SI values) or "springs".
  std::string form = {};

  ParameterKind kind = ParameterKind::text;
  int length = 0;         // of an array; 0: any
  std::string unit = {};  // "N/m"; empty: none

  /// Range of a number, or of each number of an array; empty: unlimited.
  std::optional<double> min = {}, max = {};
  bool excludes_min = false;  // values are above `min`

  std::string default_value = {};  // as TOML; empty: none, or dependent on other parameters

  bool required = false;                       // the parameter, or one of `alternatives`
  std::vector<std::string> alternatives = {};  // keys in the same table: "mesh"

  std::vector<std::string> choices = {};  // valid values as TOML; of numbers: values besides the range
  std::string description = {};           // meaning, and effect of larger values; sentences
};

/// All parameters: each table in the order of scene files, its own keys first, then the tables that it
/// contains. No two have the same key and form.
WEFT_API const std::vector<Parameter>& parameters();

/// The parameter of a key and a form; with an empty form, the first with that key. Throws InputError with the
/// nearest key.
WEFT_API const Parameter& find_parameter(std::string_view key, std::string_view form = {});

}  // namespace weft
