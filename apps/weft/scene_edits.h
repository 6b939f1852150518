#pragma once
/// A scene that a person edits: undo, redo, and whether it is saved.

#include <filesystem>
#include <string>
#include <vector>

#include "weft/scene/scene_desc.h"

namespace weft::engine::app {

class SceneEdits {
 public:
  SceneEdits() = default;
  SceneEdits(SceneDesc scene, std::filesystem::path file)
      : now_(std::move(scene)), saved_(now_), file_(std::move(file)) {}

  const SceneDesc& now() const { return now_; }
  const std::filesystem::path& file() const { return file_; }  // that it was read from or saved to
  bool is_changed() const { return !(now_ == saved_); }
  bool can_undo() const { return !past_.empty(); }
  bool can_redo() const { return !future_.empty(); }

  /// Edits of the same `what` in sequence are undone together, until settle(): the drag of a slider.
  void edit(SceneDesc next, const std::string& what);
  void settle() { what_.clear(); }
  void undo();
  void redo();

  /// Writes a scene file that is read back equal. Throws InputError if it cannot be written.
  void save(const std::filesystem::path& file);

 private:
  SceneDesc now_, saved_;
  std::vector<SceneDesc> past_, future_;  // the last one is the nearest
  std::string what_;                      // of the last edit, if the next one may join it
  std::filesystem::path file_;
};

}  // namespace weft::engine::app
