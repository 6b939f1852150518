#pragma once
/// Threads: oneTBB, none, or the caller's own job system.

#include <memory>

#include "weft/export.h"

namespace weft {

/// A job, called with its index. It refers to the callable it was made from, which must outlive run().
class Job {
 public:
  template <class Body>
  Job(const Body& body)
      : body_(&body), call_([](const void* b, int index) { (*static_cast<const Body*>(b))(index); }) {}

  void operator()(int index) const { call_(body_, index); }

 private:
  const void* body_;
  void (*call_)(const void*, int);
};

/// Runs independent jobs. Implement it to let Weft use your engine's threads.
class WEFT_API JobSystem {
 public:
  virtual ~JobSystem() = default;

  /// Number of threads that jobs may run on concurrently, >= 1 [1].
  virtual int num_threads() const = 0;

  /// Calls job(0) … job(num_jobs - 1), in any order, on any thread, and returns when all are done.
  virtual void run(int num_jobs, const Job& job) = 0;
};

/// Runs everything on the calling thread.
WEFT_API std::unique_ptr<JobSystem> make_serial_jobs();

/// oneTBB with its own arena of `num_threads` (>= 1) threads. One thread gives make_serial_jobs().
WEFT_API std::unique_ptr<JobSystem> make_jobs(int num_threads);

}  // namespace weft
