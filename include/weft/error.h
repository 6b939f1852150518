#pragma once
/// The library's only exception: bad input. Numerical failures are never thrown; StepReport reports them.

#include <stdexcept>
#include <string>

#include "weft/export.h"

namespace weft {

/// Invalid input. what() is a full sentence: the error, its place, and the expected value.
class WEFT_API InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
};

}  // namespace weft
