#pragma once
/// The one exception of the library: bad input. Numerical trouble is never thrown; StepReport reports it.

#include <stdexcept>
#include <string>

#include "weft/export.h"

namespace weft {

/// Input that cannot be used. what() is a full sentence: what is wrong, where, and what was expected.
class WEFT_API InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& sentence) : std::runtime_error(sentence) {}
};

}  // namespace weft
