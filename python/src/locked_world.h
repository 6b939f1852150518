#pragma once
/// A world that is used by one call at a time.

#include <unistd.h>

#include <atomic>
#include <memory>
#include <optional>

#include "casts.h"

namespace weft::python {

/// A world with its threads. A second Python thread gets an error, not a race.
struct LockedWorld {
  std::shared_ptr<World> world;
  int threads = 1;
  pid_t process = getpid();  // that made the threads
  std::atomic<bool> is_busy = false;

  explicit LockedWorld(World w) : world(std::make_shared<World>(std::move(w))) { set_threads(1); }
  explicit LockedWorld(std::shared_ptr<World> of_batch) : world(std::move(of_batch)) {}

  void set_threads(int count) {
    if (count < 1) throw InputError("threads: expected at least 1, found " + std::to_string(count));
    world->set_jobs(make_jobs(count));
    threads = count;
    process = getpid();
  }
};

/// Use of a world by a call, without Python's global lock.
class Use {
 public:
  explicit Use(LockedWorld& own) : own_(own) {
    if (own.threads > 1 && own.process != getpid())
      throw std::runtime_error(
          "the threads of this world did not survive fork(); start processes with multiprocessing's "
          "\"spawn\", or "
          "set world.threads = 1 before the fork");
    if (own.is_busy.exchange(true))
      throw std::runtime_error("another thread is using this world; use one world per thread, or a lock");
    release_.emplace();
  }
  ~Use() {
    release_.reset();
    own_.is_busy = false;
  }
  Use(const Use&) = delete;
  Use& operator=(const Use&) = delete;

  World& operator*() const { return *own_.world; }
  World* operator->() const { return own_.world.get(); }

 private:
  LockedWorld& own_;
  std::optional<nb::gil_scoped_release> release_;
};

/// Calls a function with the world while Python's global lock is free.
template <class Call>
auto with(LockedWorld& own, const Call& call) {
  const Use use(own);
  return call(*use);
}

/// A getter of World as a method of LockedWorld.
template <class Result, class... Arguments>
auto get(Result (World::*getter)(Arguments...) const) {
  return [getter](LockedWorld& own, const Arguments&... arguments) {
    return with(own, [&](const World& w) { return (w.*getter)(arguments...); });
  };
}

}  // namespace weft::python
