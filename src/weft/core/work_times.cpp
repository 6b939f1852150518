#include "weft/core/work_times.h"

#include <algorithm>

namespace weft {

WorkTimes& WorkTimes::operator+=(const WorkTimes& other) {
  for (const auto seconds : {&WorkTimes::total, &WorkTimes::lists, &WorkTimes::narrow_phase, &WorkTimes::rows,
                             &WorkTimes::set_up, &WorkTimes::product, &WorkTimes::v_cycle,
                             &WorkTimes::projection, &WorkTimes::ccd, &WorkTimes::retries})
    this->*seconds += other.*seconds;
  for (const auto count :
       {&WorkTimes::looks, &WorkTimes::pairs_tested, &WorkTimes::active, &WorkTimes::list_renewals})
    this->*count += other.*count;
  pairs_listed = std::max(pairs_listed, other.pairs_listed);
  return *this;
}

}  // namespace weft
