#include "scene_edits.h"

#include <utility>

#include "weft/scene/scene_writer.h"

namespace weft::engine::app {

void SceneEdits::edit(SceneDesc next, const std::string& what) {
  if (next == now_) return;
  if (what_ != what) past_.push_back(now_);
  what_ = what;
  future_.clear();
  now_ = std::move(next);
}

void SceneEdits::undo() {
  if (past_.empty()) return;
  future_.push_back(std::exchange(now_, past_.back()));
  past_.pop_back();
  settle();
}

void SceneEdits::redo() {
  if (future_.empty()) return;
  past_.push_back(std::exchange(now_, future_.back()));
  future_.pop_back();
  settle();
}

void SceneEdits::save(const std::filesystem::path& file) {
  write_scene(file, now_);
  saved_ = now_;
  file_ = file;
  settle();
}

}  // namespace weft::engine::app
