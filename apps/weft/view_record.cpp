#include "view_record.h"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "apps/common/command_line.h"
#include "viewer.h"
#include "weft/core/staged_file.h"
#include "weft/error.h"
#include "weft/pictures/painter.h"
#include "weft/render/legend.h"
#include "weft/scene/scene_writer.h"

namespace weft::engine::app {
namespace {

namespace fs = std::filesystem;

/// Images of one height, side by side.
Image join(const std::vector<Image>& images) {
  return images.size() == 1 ? images[0] : make_contact_sheet(images, static_cast<int>(images.size()), 0);
}

bool can_tear(const SceneDesc& scene) {
  return std::ranges::any_of(
      scene.cloths, [](const ClothSceneDesc& c) { return c.fabric && c.fabric->numbers.strength > 0; });
}

}  // namespace

Recording::Recording(Viewer& viewer, const RecordRequest& request)
    : viewer_(viewer), request_(request), size_(parse_size(request.size)) {
  size_.width -= size_.width % viewer_.num_sides();
  const fs::path file = request_.file;
  const double rate = viewer_.frames_per_second() / request_.every;
  if (file.extension() == ".glb") {
    if (viewer_.num_sides() > 1) throw InputError("a .glb holds one simulation: record it without --compare");
    if (viewer_.edits() && can_tear(viewer_.edits()->now()))
      throw InputError("the window records no .glb of cloth that tears: use weft run");
    glb_file_ = std::make_unique<StagedFile>(file);
    glb_ = std::make_unique<GlbWriter>(*glb_file_, without_frames(viewer_.side(0).meshes()));
  } else if (is_video(file)) {
    require_ffmpeg(file);
    video_ = std::make_unique<VideoWriter>(file, size_.width, size_.height, rate);
  } else if (!is_sequence(file)) {
    throw InputError(
        "record to a .mp4, .webp, .gif or .glb file, or to numbered pictures as in frame_####.png; not " +
        file.string());
  }
  if (viewer_.edits()) write_parameters();
  if (!viewer_.is_simulation()) {
    asked_from_.assign(1, -1);
    return;
  }
  const int steps = viewer_.edits()->now().steps_per_frame;
  for (int s = 0; s < viewer_.num_sides(); ++s) {
    const bool is_between = viewer_.side(s).status()->steps % steps == 0;
    asked_from_.push_back(is_between ? -1 : viewer_.side(s).status()->steps);
    if (!is_between) viewer_.side(s).step_frame(false);
  }
}

Recording::~Recording() = default;

void Recording::advance(Renderer& renderer) {
  if (has_failed()) return finish();
  if (!is_there()) return;
  if (frame_ % request_.every == 0) add(renderer);
  ++frame_;
  const bool is_last =
      !viewer_.is_simulation() && viewer_.side(0).frame() + 1 >= viewer_.side(0).num_frames();
  if (frame_ > request_.frames || is_last) return finish();
  ask_for_next();
}

bool Recording::has_failed() const {
  for (int s = 0; s < viewer_.num_sides(); ++s) {
    const LiveStatus* status = viewer_.side(s).status();
    if (status && !status->failure.empty()) return true;
  }
  return false;
}

bool Recording::is_there() const {
  for (int s = 0; s < viewer_.num_sides(); ++s) {
    const LiveStatus* status = viewer_.side(s).status();
    if (!status) return viewer_.side(s).frame() != asked_from_[s];
    if (status->steps == asked_from_[s] || status->steps % viewer_.edits()->now().steps_per_frame != 0)
      return false;
  }
  return true;
}

void Recording::ask_for_next() {
  for (int s = 0; s < viewer_.num_sides(); ++s) {
    ViewSide& side = viewer_.side(s);
    asked_from_[s] = side.status() ? side.status()->steps : side.frame();
    side.step_frame(false);
  }
}

void Recording::add(Renderer& renderer) {
  ++drawn_;
  if (glb_) {
    AnimationFrame frame = viewer_.side(0).current_frame();
    frame.values.clear();
    return glb_->add_frame(frame);
  }
  const Image image = draw(renderer);
  if (video_) return video_->add(image);
  write_image(numbered_picture(request_.file, frame_), image);
}

Image Recording::draw(Renderer& renderer) const {
  renderer.set_settings({});
  const PictureSize part{size_.width / viewer_.num_sides(), size_.height};
  std::vector<Image> images;
  for (int s = 0; s < viewer_.num_sides(); ++s) {
    images.push_back(
        renderer.draw(viewer_.side(s).draw(viewer_.camera(), viewer_.look, viewer_.scales(), true), part));
  }
  Image image = join(images);
  if (viewer_.look.color)
    draw_legend(image, {label_of(*viewer_.look.color).text(), {0, viewer_.scales().color}});
  return image;
}

void Recording::finish() {
  is_done_ = true;
  if (drawn_ == 0) return;
  if (video_) video_->finish();
  if (!glb_) return;
  glb_->finish();
  glb_file_->replace();
}

void Recording::write_parameters() const {
  const fs::path file = request_.file + ".toml";
  SceneDesc scene = viewer_.edits()->now();
  const std::string integrator = viewer_.side(0).status()->integrator;
  if (viewer_.num_sides() == 1) scene.solver.integrator = integrator;
  write_scene(file, scene);
  std::ifstream in(file);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  write_file(
      file,
      fmt::format("# Recorded by weft view from frame {} on. From the start, without hands:\n#   {}\n\n{}",
                  viewer_.side(0).status()->frames, command(), text));
}

std::string Recording::command() const {
  const std::string scene = request_.file + ".toml";
  if (glb_) return fmt::format("weft run '{}' --frames {}", scene, request_.frames);
  const Camera& camera = viewer_.camera();
  std::string words = fmt::format(
      "weft render '{}' --out '{}' --frames {} --every {} --size {}x{} --camera {:.6g},{:.6g} "
      "--look-at {:.6g},{:.6g},{:.6g} --distance {:.6g}",
      scene, request_.file, request_.frames, request_.every, size_.width, size_.height, camera.azimuth_deg,
      camera.elevation_deg, camera.target.x(), camera.target.y(), camera.target.z(), camera.distance);
  if (viewer_.look.color)
    words +=
        fmt::format(" --color {} --range 0,{:g}", label_of(*viewer_.look.color).word, viewer_.scales().color);
  return words;
}

}  // namespace weft::engine::app
