#include "weft/pictures/painter.h"

#include <algorithm>

#include "weft/error.h"
#include "weft/render/legend.h"
#include "weft/render/video.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

constexpr int kSheetGap = 6;  // between the pictures of a contact sheet [pixels]
constexpr int kMaxColumns = 4;

PaintSettings complete(PaintSettings settings, const Animation& animation) {
  if (!settings.style.smooth) settings.style.smooth = choose_smoothness(animation);
  return settings;
}

/// "frame_####.png" as "frame_0012.png".
fs::path numbered(const fs::path& file, int frame) {
  std::string name = file.filename().string(), digits = std::to_string(frame);
  const std::size_t begin = name.find('#'), end = name.find_first_not_of('#', begin);
  const std::size_t width = (end == std::string::npos ? name.size() : end) - begin;
  if (digits.size() < width) digits.insert(0, width - digits.size(), '0');
  return file.parent_path() / name.replace(begin, width, digits);
}

}  // namespace

void require_picture(const fs::path& file) {
  if (is_picture(file) || is_video(file)) return;
  throw InputError(file.string() + ": expected a file name ending in .png, .jpg, .mp4, .webp or .gif");
}

void require_frames(const std::vector<int>& frames, int last) {
  for (const int frame : frames) {
    if (frame > last)
      throw InputError("there is no frame " + std::to_string(frame) + "; the last one is " +
                       std::to_string(last));
  }
}

bool is_sequence(const fs::path& file) {
  return is_picture(file) && file.filename().string().find('#') != std::string::npos;
}

Painter::Painter(const Animation& animation, const PaintSettings& settings, std::unique_ptr<Device> device)
    : animation_(animation),
      settings_(complete(settings, animation)),
      renderer_(std::move(device), settings_.render),
      pictures_(animation, settings_.style),
      last_(num_frames(animation) - 1) {
  if (last_ < 0) throw InputError("there is no cloth to draw");
}

Camera Painter::frame(const std::vector<int>& frames) const {
  if (settings_.camera) return *settings_.camera;
  Camera camera = frame_scene(animation_, frames, settings_.view, settings_.size.aspect(), settings_.framed);
  camera.zoom(1 / settings_.zoom);
  if (settings_.look_at) camera.target = *settings_.look_at;
  return camera;
}

Image Painter::draw(int frame, const Camera& camera) {
  Image image = renderer_.draw(pictures_.at(frame, camera), settings_.size);
  if (const auto& values = settings_.style.values) draw_legend(image, {values->title, values->range});
  return image;
}

void Painter::write_pictures(const fs::path& file, const std::vector<int>& frames, int columns) {
  require_frames(frames, last_);
  const Camera camera = this->frame(frames);
  std::vector<Image> images;
  for (const int frame : frames) images.push_back(draw(frame, camera));
  if (columns == 0) columns = std::min(kMaxColumns, static_cast<int>(images.size()));
  write_image(file, images.size() == 1 ? images[0] : make_contact_sheet(images, columns, kSheetGap));
}

std::vector<int> Painter::every(int step) const {
  std::vector<int> frames;
  for (int frame = 0; frame <= last_; frame += step) frames.push_back(frame);
  return frames;
}

void Painter::write_video(const fs::path& file, int every, const GoOn& go_on) {
  VideoWriter video(file, settings_.size.width, settings_.size.height, animation_.frames_per_second / every);
  const std::vector<int> frames = this->every(every);
  const Camera camera = frame(frames);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    video.add(draw(frames[k], camera));
    if (go_on && !go_on(static_cast<int>(k + 1), static_cast<int>(frames.size()))) break;
  }
  video.finish();
}

void Painter::write_sequence(const fs::path& file, int every, const GoOn& go_on) {
  const std::vector<int> frames = this->every(every);
  const Camera camera = frame(frames);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    write_image(numbered(file, frames[k]), draw(frames[k], camera));
    if (go_on && !go_on(static_cast<int>(k + 1), static_cast<int>(frames.size()))) break;
  }
}

}  // namespace weft::engine
