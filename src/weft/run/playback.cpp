#include "weft/run/playback.h"

#include <algorithm>
#include <cmath>

#include "weft/error.h"
#include "weft/face/world_impl.h"
#include "weft/io/glb_reader.h"
#include "weft/run/checkpoint.h"
#include "weft/run/film.h"
#include "weft/run/run_folder.h"
#include "weft/run/scene_run.h"

namespace weft::engine {

namespace fs = std::filesystem;

Playback::Playback(const fs::path& path) {
  if (!fs::is_directory(path)) {
    open(path);
    return;
  }
  const PastRun run = read_past_run(path);
  if (!run.frames.empty())
    open_unfinished(run);
  else if (!run.animation.empty())
    open(run.animation);
  else
    throw InputError(path.string() + " has no frames to show: it was run with --no-glb");
}

void Playback::open(const fs::path& glb) {
  frames_ = read_glb(glb);
  if (frames_.cloths.empty()) throw InputError(glb.string() + ": has no cloth to show");
  meshes_ = without_frames(frames_);
  replace_frames(get_frame(frames_, 0), meshes_);
}

void Playback::open_unfinished(const PastRun& run) {
  const SceneDesc scene = read_unfinished_run(run.folder).scene;
  const Checkpoint checkpoint = read_checkpoint(run.folder / kUnfinishedName / kCheckpointName);
  const weft::World world = load_world(checkpoint.run);
  meshes_ = make_animation(scene, WorldAccess::engine(world));
  log_.emplace(run.frames, capture_frame(WorldAccess::engine(world)));
  replace_frames(read(0), meshes_);
}

int Playback::num_frames() { return log_ ? log_->num_frames() : static_cast<int>(count_frames(frames_)); }

AnimationFrame Playback::read(int frame) {
  return log_ ? log_->read(frame) : get_frame(frames_, static_cast<std::size_t>(frame));
}

void PlayHead::advance(double seconds, int num_frames) {
  if (!is_playing) return;
  position += seconds * frames_per_second;
  if (position < num_frames) return;
  if (loops) {
    position = std::fmod(position, num_frames);
  } else {
    seek(num_frames - 1, num_frames);
    is_playing = false;
  }
}

void PlayHead::play(int num_frames) {
  if (!loops && frame() == num_frames - 1) position = 0;
  is_playing = true;
}

void PlayHead::seek(int frame, int num_frames) { position = std::clamp(frame, 0, num_frames - 1); }

void PlayHead::step(int count, int num_frames) {
  is_playing = false;
  seek(frame() + count, num_frames);
}

}  // namespace weft::engine
