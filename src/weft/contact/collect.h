#pragma once
/// Private to contact/: gathers the results of many small parallel searches in a fixed order.

#include <algorithm>
#include <vector>

#include "weft/core/job_system.h"

namespace weft::engine {

/// Calls work(i, chunk) for i in [0, count), in parallel in chunks of `grain`, and gather(chunk) for one
/// chunk after the other: results are gathered in the order of i, for any number of threads. `chunks` is
/// work space of a bounded number of chunks; each is cleared by clear().
template <class Chunk, class Work, class Gather>
void collect_in_order(JobSystem& jobs, int count, int grain, std::vector<Chunk>& chunks, const Work& work,
                      const Gather& gather) {
  constexpr int kChunksPerThread = 4;  // at once
  const int num_chunks = (count + grain - 1) / grain,
            num_at_once = std::min(num_chunks, kChunksPerThread * jobs.num_threads());
  if (static_cast<int>(chunks.size()) < num_at_once) chunks.resize(num_at_once);
  for (int first = 0; first < num_chunks; first += num_at_once) {
    const int num_now = std::min(num_at_once, num_chunks - first);
    parallel_for(jobs, num_now, 1, [&](int c, int) {
      Chunk& chunk = chunks[c];
      chunk.clear();
      const int begin = (first + c) * grain, end = std::min(begin + grain, count);
      for (int i = begin; i < end; ++i) work(i, chunk);
    });
    for (int c = 0; c < num_now; ++c) gather(chunks[c]);
  }
}

}  // namespace weft::engine
