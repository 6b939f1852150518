#include "weft/run/playback.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "weft/error.h"
#include "weft/face/world_impl.h"
#include "weft/io/glb_reader.h"
#include "weft/run/checkpoint.h"
#include "weft/run/film.h"
#include "weft/run/frame_log.h"
#include "weft/run/run_folder.h"
#include "weft/run/scene_run.h"
#include "weft/scene/scene_reader.h"
#include "weft/scene/scene_world.h"

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

/// The frames of a finished run: cloth from point caches, colliders from their motions.
class CachedFrames final : public FrameSource {
 public:
  CachedFrames(const PastRun& run, PastWorld& world)
      : meshes_(make_animation(world.scene(), world.world())), world_(world) {
    for (const PastCloth& cloth : run.cloths) {
      caches_.push_back(open_cache(run, cloth));
      num_frames_ = std::min(num_frames_, caches_.back()->num_frames());
    }
    if (num_frames_ == 0) throw InputError(run.folder.string() + " has no frame yet");
  }

  const Animation& meshes() const override { return meshes_; }
  int num_frames() override { return num_frames_; }

  AnimationFrame read(int frame) override {
    world_.set_time(frame / meshes_.frames_per_second);
    AnimationFrame result = capture_frame(world_.world());
    for (std::size_t c = 0; c < caches_.size(); ++c)
      result.cloths[c] = world_.to_particles(static_cast<int>(c), caches_[c]->frame(frame));
    return result;
  }

 private:
  Animation meshes_;
  PastWorld& world_;
  std::vector<std::unique_ptr<PointCacheReader>> caches_;
  int num_frames_ = std::numeric_limits<int>::max();
};

/// Frames that own their world.
class FramesOfScene final : public FrameSource {
 public:
  explicit FramesOfScene(FramesAndWorld all) : all_(std::move(all)) {}

  const Animation& meshes() const override { return all_.frames->meshes(); }
  int num_frames() override { return all_.frames->num_frames(); }
  AnimationFrame read(int frame) override { return all_.frames->read(frame); }

 private:
  FramesAndWorld all_;
};

FramesAndWorld open_unfinished(const PastRun& run) {
  FramesAndWorld result;
  const Checkpoint checkpoint = read_checkpoint(run.folder / kUnfinishedName / kCheckpointName);
  result.world =
      std::make_unique<PastWorld>(read_unfinished_run(run.folder).scene, load_world(checkpoint.run));
  const World& world = result.world->world();
  result.frames = std::make_unique<FramesSoFar>(make_animation(result.world->scene(), world), run.frames,
                                                capture_frame(world));
  return result;
}

/// Of a finished run with its scene. Throws InputError if that or a point cache is missing, or has changed.
FramesAndWorld open_scene(const PastRun& run) {
  if (run.animation.empty() && run.cloths[0].cache.empty())
    throw InputError(run.folder.string() + " has no frames to show: it was run with --no-glb and --no-pc2");
  if (run.scene.empty())
    throw InputError(run.folder.string() + " has no scene: it is of an earlier version of Weft");
  SceneDesc scene = read_scene(run.scene);
  scene.name = run.name;
  if (hash_of_scene(scene) != run.scene_hash)
    throw InputError(run.scene.string() + ": scene or meshes have changed since the run");
  FramesAndWorld result;
  result.world = std::make_unique<PastWorld>(scene, place_scene(scene, make_serial_jobs()).world);
  result.frames = std::make_unique<CachedFrames>(run, *result.world);
  result.counts = read_counts(run);
  return result;
}

/// The frames alone, if a cloth tears: they do not show its state.
FramesAndWorld without_torn_world(FramesAndWorld all) {
  const World& world = all.world->world();
  for (int c = 0; c < world.num_cloths(); ++c) {
    const ClothId cloth = world.cloth(c);
    if (!world.can_tear(cloth)) continue;
    const std::string why_not =
        "cloth \"" + world.name(cloth) + "\" tears: its past frames are positions only";
    return {.why_not = why_not, .frames = std::make_unique<FramesOfScene>(std::move(all))};
  }
  return all;
}

}  // namespace

std::unique_ptr<FrameSource> open_frames(const fs::path& path) {
  if (!fs::is_directory(path)) return open_glb(path);
  const PastRun run = read_past_run(path);
  if (!run.frames.empty()) return open_unfinished(run).frames;
  if (!run.animation.empty()) return open_glb(run.animation);
  return std::make_unique<FramesOfScene>(open_scene(run));
}

FramesAndWorld open_frames_and_world(const fs::path& path) {
  if (!fs::is_directory(path))
    return {.why_not = path.string() + " contains positions only", .frames = open_glb(path)};
  const PastRun run = read_past_run(path);
  if (!run.frames.empty()) return without_torn_world(open_unfinished(run));
  try {
    return without_torn_world(open_scene(run));
  } catch (const InputError& error) {
    if (run.animation.empty()) throw;
    return {.why_not = error.what(), .frames = open_glb(run.animation)};
  }
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
