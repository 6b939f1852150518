#include "weft/run/playback.h"

#include <algorithm>
#include <cmath>

#include "weft/error.h"
#include "weft/face/world_impl.h"
#include "weft/io/glb_reader.h"
#include "weft/run/checkpoint.h"
#include "weft/run/film.h"
#include "weft/run/frame_log.h"
#include "weft/run/run_folder.h"
#include "weft/run/scene_run.h"

namespace weft::engine {

namespace fs = std::filesystem;

namespace {

std::unique_ptr<FrameSource> open_glb(const fs::path& glb) {
  auto frames = std::make_unique<GlbFrames>(glb);
  if (frames->meshes().cloths.empty()) throw InputError(glb.string() + ": has no cloth to show");
  return frames;
}

/// The frames of an unfinished run so far.
class FramesSoFar final : public FrameSource {
 public:
  FramesSoFar(Animation meshes, const fs::path& log, AnimationFrame like)
      : meshes_(std::move(meshes)), log_(log, std::move(like)) {}

  const Animation& meshes() const override { return meshes_; }
  int num_frames() override { return log_.num_frames(); }
  AnimationFrame read(int frame) override { return log_.read(frame); }

 private:
  Animation meshes_;
  FrameLogReader log_;
};

std::unique_ptr<FrameSource> open_unfinished(const PastRun& run) {
  const SceneDesc scene = read_unfinished_run(run.folder).scene;
  const Checkpoint checkpoint = read_checkpoint(run.folder / kUnfinishedName / kCheckpointName);
  const weft::World world = load_world(checkpoint.run);
  return std::make_unique<FramesSoFar>(make_animation(scene, WorldAccess::engine(world)), run.frames,
                                       capture_frame(WorldAccess::engine(world)));
}

}  // namespace

std::unique_ptr<FrameSource> open_frames(const fs::path& path) {
  if (!fs::is_directory(path)) return open_glb(path);
  const PastRun run = read_past_run(path);
  if (!run.frames.empty()) return open_unfinished(run);
  if (!run.animation.empty()) return open_glb(run.animation);
  throw InputError(path.string() + " has no frames to show: it was run with --no-glb");
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
