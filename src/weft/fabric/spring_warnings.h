#pragma once
/// Private to fabric/: what springs that stand for a fabric have to tell.

#include <string>
#include <vector>

#include "weft/fabric.h"

namespace weft::engine {

/// A number in four digits.
std::string short_text(double number);

/// What no springs can be, on whatever mesh: C12 other than G, stretch curves.
std::vector<std::string> warn_of_springs(const Fabric& fabric, const std::string& name);

}  // namespace weft::engine
