#pragma once
/// Private to contact/: results of many small searches, found side by side and kept in order.

#include <vector>

#include "weft/core/job_system.h"

namespace weft {

/// Calls work(i, chunk) for i from 0 to before `count`, side by side in chunks of `grain`, then gather(chunk)
/// for one chunk after the other: what is gathered has the order of i, for any number of threads. `chunks` is
/// work space; each is cleared by clear().
template <class Chunk, class Work, class Gather>
void collect_in_order(JobSystem& jobs, int count, int grain, std::vector<Chunk>& chunks, const Work& work,
                      const Gather& gather) {
  const std::size_t num_chunks = (count + grain - 1) / grain;
  if (chunks.size() < num_chunks) chunks.resize(num_chunks);
  parallel_for(jobs, count, grain, [&](int begin, int end) {
    Chunk& chunk = chunks[begin / grain];
    chunk.clear();
    for (int i = begin; i < end; ++i) work(i, chunk);
  });
  for (std::size_t c = 0; c < num_chunks; ++c) gather(chunks[c]);
}

}  // namespace weft
