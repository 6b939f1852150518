#pragma once
/// The start of the window without a scene: the shipped scenes with their pictures, recent files, a path.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace weft::engine::app {

class Viewer;

struct GalleryEntry {
  std::string name;
  std::filesystem::path picture;  // beside the scene; may be missing
  std::uint64_t texture = 0;      // of the picture; 0: none yet
  bool is_loaded = false;         // or has no picture
};

struct Gallery {
  std::vector<GalleryEntry> entries;
  std::vector<std::string> recent;
  std::string path;  // typed
};

/// Throws InputError if the shipped scenes are not found.
Gallery make_gallery();

/// Fills the window. Call within a frame of the viewer's window.
void draw_gallery(Viewer& viewer, Gallery& gallery);

}  // namespace weft::engine::app
