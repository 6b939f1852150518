#pragma once
/// The exact checker for frames that are shown, on a thread of its own.

#include <future>
#include <optional>

#include "weft/io/animation.h"
#include "weft/run/frame_checks.h"

namespace weft::engine::app {

class ViewChecker {
 public:
  /// Takes the findings of the last check when it is done, and then starts one of this frame if its number is
  /// another. True: there are new findings.
  bool update(const Animation& meshes, const AnimationFrame& frame, std::int64_t number);

  const std::optional<FrameFindings>& findings() const { return findings_; }  // the newest; empty: none yet

 private:
  std::future<FrameFindings> running_;
  std::optional<FrameFindings> findings_;
  std::int64_t checked_ = -1;  // number of the last frame that was started
};

}  // namespace weft::engine::app
