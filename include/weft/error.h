#pragma once
/// The library's exceptions: bad input, and pictures without graphics. Numerical failures are never thrown;
/// StepReport reports them.

#include <stdexcept>
#include <string>

#include "weft/export.h"

namespace weft {

/// Invalid input. what() is a full sentence: the error, its place, and the expected value.
class WEFT_API InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
};

/// No graphics on this machine, for pictures in colour and windows. what() is the missing part, and a remedy.
class WEFT_API GraphicsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace weft
