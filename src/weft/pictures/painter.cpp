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

PaintSettings complete(PaintSettings settings, FrameSource& source) {
  if (source.meshes().cloths.empty()) throw InputError("there is no cloth to draw");
  if (!settings.style.smooth) settings.style.smooth = choose_smoothness(source.meshes());
  if (settings.finds_ground && !settings.style.ground) settings.style.ground = find_ground(source);
  return settings;
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

fs::path numbered_picture(const fs::path& file, int frame) {
  std::string name = file.filename().string(), digits = std::to_string(frame);
  const std::size_t begin = name.find('#'), end = name.find_first_not_of('#', begin);
  const std::size_t width = (end == std::string::npos ? name.size() : end) - begin;
  if (digits.size() < width) digits.insert(0, width - digits.size(), '0');
  return file.parent_path() / name.replace(begin, width, digits);
}

Painter::Painter(FrameSource& frames, const PaintSettings& settings, std::unique_ptr<Device> device)
    : source_(frames),
      settings_(complete(settings, frames)),
      renderer_(std::move(device), settings_.render),
      pictures_(frames.meshes(), frames.read(0), settings_.style),
      last_(frames.num_frames() - 1) {}

Camera Painter::frame(const std::vector<int>& frames) const {
  if (settings_.camera) return *settings_.camera;
  Camera camera = frame_scene(source_, frames, settings_.view, settings_.size.aspect(), settings_.framed);
  camera.zoom(1 / settings_.zoom);
  if (settings_.look_at) camera.target = *settings_.look_at;
  return camera;
}

Image Painter::draw(int frame, const Camera& camera) {
  Image image = renderer_.draw(pictures_.at(source_.read(frame), camera), settings_.size);
  if (!settings_.legend.empty()) draw_legend(image, {settings_.legend, settings_.style.range});
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
  VideoWriter video(file, settings_.size.width, settings_.size.height,
                    source_.meshes().frames_per_second / every);
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
    write_image(numbered_picture(file, frames[k]), draw(frames[k], camera));
    if (go_on && !go_on(static_cast<int>(k + 1), static_cast<int>(frames.size()))) break;
  }
}

}  // namespace weft::engine
