#include "view_scale.h"

#include <cmath>
#include <initializer_list>

namespace weft::engine::app {
namespace {

constexpr double kFarSmaller = 0.15;  // than the end, as a share [1]

}  // namespace

double round_up(double value) {
  if (!(value > 0)) return 1;
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double digit : {1, 2, 5}) {
    if (digit * power >= value) return digit * power;
  }
  return 10 * power;
}

void RoundScale::update(double largest) {
  if (!(largest > 0)) return;
  if (!is_new_ && largest <= end_ && largest > kFarSmaller * end_) return;
  end_ = round_up(largest);
  is_new_ = false;
}

}  // namespace weft::engine::app
