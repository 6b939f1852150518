#pragma once
/// Threads, behind one small interface: oneTBB, nothing at all, or the caller's own job system.

#include <functional>
#include <memory>

namespace weft {

/// Runs independent jobs. Implement it to let Weft use your engine's threads.
class JobSystem {
 public:
  virtual ~JobSystem() = default;

  /// Threads that jobs may run on at once [1].
  virtual int num_threads() const = 0;

  /// Calls job(0) … job(num_jobs - 1), in any order, on any thread, and returns when all are done.
  virtual void run(int num_jobs, const std::function<void(int)>& job) = 0;
};

/// Everything on the calling thread.
std::unique_ptr<JobSystem> make_serial_jobs();

/// oneTBB with its own arena of `num_threads` (>= 1) threads. One thread gives make_serial_jobs().
std::unique_ptr<JobSystem> make_jobs(int num_threads);

/// Calls body(begin, end) over [0, count) cut into chunks of `grain`. The cut depends on `grain` alone,
/// never on the number of threads, so whatever is computed per chunk has the same bits for any of them.
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

}  // namespace weft
