#include "view_checker.h"

#include <chrono>

namespace weft::engine::app {
namespace {

constexpr int kPlaces = 200;  // crossings that are marked, at most [1]

}  // namespace

bool ViewChecker::update(const Animation& meshes, const AnimationFrame& frame, std::int64_t number) {
  bool has_news = false;
  if (running_.valid()) {
    if (running_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
    findings_ = running_.get();
    has_news = true;
  }
  if (number == checked_) return has_news;
  checked_ = number;
  running_ = std::async(std::launch::async, [meshes, frame] { return check_frame(meshes, frame, kPlaces); });
  return has_news;
}

}  // namespace weft::engine::app
