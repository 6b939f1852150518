#pragma once
/// Messages of errors.

#include <functional>
#include <string>

#include "weft/error.h"

namespace weft {

/// The message of the InputError that the call throws, or "no error".
inline std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace weft
