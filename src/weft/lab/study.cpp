#include "weft/lab/study.h"

#include <cmath>
#include <cstdio>

namespace weft::engine {

bool Figure::is_as_expected() const { return !expected || std::abs(value - *expected) <= tolerance; }

std::string digits(double value, int significant) {
  char buffer[48];
  std::snprintf(buffer, sizeof buffer, "%.*g", significant, value);
  return buffer;
}

}  // namespace weft::engine
