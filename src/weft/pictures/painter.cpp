#include "weft/pictures/painter.h"

#include <algorithm>

#include "weft/error.h"
#include "weft/render/video.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

constexpr int kSheetGap = 6;  // between the pictures of a contact sheet [pixels]
constexpr int kMaxColumns = 4;

}  // namespace

void require_picture(const fs::path& file) {
  if (is_picture(file) || is_video(file)) return;
  throw InputError(file.string() + ": expected a file name ending in .png, .jpg, .mp4, .webp or .gif");
}

Painter::Painter(const Animation& animation, const PaintSettings& settings, std::unique_ptr<Device> device)
    : animation_(animation),
      settings_(settings),
      renderer_(std::move(device), settings.render),
      pictures_(animation, settings.style),
      last_(num_frames(animation) - 1) {
  if (last_ < 0) throw InputError("there is no cloth to draw");
}

Camera Painter::frame(const std::vector<int>& frames) const {
  if (settings_.camera) return *settings_.camera;
  Camera camera = frame_scene(animation_, frames, settings_.view, settings_.size.aspect());
  camera.zoom(1 / settings_.zoom);
  return camera;
}

Image Painter::draw(int frame, const Camera& camera) {
  return renderer_.draw(pictures_.at(frame, camera), settings_.size);
}

void Painter::write_pictures(const fs::path& file, const std::vector<int>& frames, int columns) {
  for (const int frame : frames) {
    if (frame > last_)
      throw InputError("there is no frame " + std::to_string(frame) + "; the last one is " +
                       std::to_string(last_));
  }
  const Camera camera = this->frame(frames);
  std::vector<Image> images;
  for (const int frame : frames) images.push_back(draw(frame, camera));
  if (columns == 0) columns = std::min(kMaxColumns, static_cast<int>(images.size()));
  write_image(file, images.size() == 1 ? images[0] : make_contact_sheet(images, columns, kSheetGap));
}

void Painter::write_video(const fs::path& file, int every, const std::function<bool()>& is_stopped) {
  VideoWriter video(file, settings_.size.width, settings_.size.height, animation_.frames_per_second / every);
  std::vector<int> frames;
  for (int frame = 0; frame <= last_; frame += every) frames.push_back(frame);
  const Camera camera = this->frame(frames);
  for (const int frame : frames) {
    video.add(draw(frame, camera));
    if (is_stopped && is_stopped()) break;
  }
  video.finish();
}

}  // namespace weft::engine
