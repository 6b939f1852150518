#pragma once
/// Loops split into jobs.

#include "weft/jobs.h"

namespace weft::engine {

/// Calls body(begin, end) over [0, count) split into chunks of `grain`. The split depends only on `grain`,
/// not on the number of threads, so results per chunk have the same bits for any of them.
template <class Body>
void parallel_for(JobSystem& jobs, int count, int grain, const Body& body) {
  const int num_chunks = (count + grain - 1) / grain;
  const auto chunk = [&](int c) {
    const int begin = c * grain;
    body(begin, begin + grain < count ? begin + grain : count);
  };
  if (num_chunks <= 1 || jobs.num_threads() == 1) {
    for (int c = 0; c < num_chunks; ++c) chunk(c);
  } else {
    jobs.run(num_chunks, chunk);
  }
}

}  // namespace weft::engine
