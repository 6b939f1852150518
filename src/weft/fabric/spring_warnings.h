#pragma once
/// Private to fabric/: warnings of springs that represent a fabric.

#include <string>
#include <vector>

#include "weft/fabric.h"

namespace weft::engine {

/// A number with four digits.
std::string short_text(double number);

/// Properties that no springs can have, on any mesh: C12 other than G, stretch curves.
std::vector<std::string> warn_of_springs(const Fabric& fabric, const std::string& name);

}  // namespace weft::engine
