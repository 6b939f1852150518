#pragma once
/// Private to scene/: descriptions of the parameters, the only texts of the table that the reader's rules do not
/// give.

#include <span>
#include <string_view>

namespace weft::engine {

struct ParameterText {
  std::string_view key, form;  // as in Parameter
  std::string_view description;
};

std::span<const ParameterText> parameter_texts();

}  // namespace weft::engine
