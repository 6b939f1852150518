#pragma once
/// The one exception of the library: bad input. Numerical trouble is never thrown; it is told by StepReport.

#include <stdexcept>
#include <string>

namespace weft {

/// Input that cannot be used. what() is a full sentence: what is wrong, where, and what was expected.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& sentence) : std::runtime_error(sentence) {}
};

}  // namespace weft
