#pragma once
/// Names in messages: suggestions for misspelled ones, and lists.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace weft::engine {

/// Minimum number of letters to insert, drop, replace or swap with their neighbour to turn `a` into `b`
/// (optimal string alignment distance); capped at `limit` + 1, which saves time.
int edit_distance(std::string_view a, std::string_view b, int limit);

/// The first nearest of `names` to `name` with at most a third of its letters changed (at least one, never
/// all), or "".
std::string find_nearest(std::string_view name, const std::vector<std::string>& names);

/// `"front", "back" and 7 more`: the first `most` names.
std::string list_names(const std::vector<std::string>& names, std::size_t most);

}  // namespace weft::engine
