#pragma once
/// What a person may have meant by a name that does not exist.

#include <string>
#include <string_view>
#include <vector>

namespace weft::engine {

/// The fewest letters to insert, drop, replace or swap with their neighbour to make `b` of `a` (optimal
/// string alignment); at most `limit` + 1, which saves time.
int edit_distance(std::string_view a, std::string_view b, int limit);

/// The first of the nearest among `names` that `name` can be made of with a third of its letters changed at
/// most (one at least, never all), "" if none can.
std::string find_nearest(std::string_view name, const std::vector<std::string>& names);

}  // namespace weft::engine
