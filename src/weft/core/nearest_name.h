#pragma once
/// Suggestions for misspelled names.

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

}  // namespace weft::engine
