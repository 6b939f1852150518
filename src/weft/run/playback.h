#pragma once
/// Frames of a run that are shown again, in their time.

#include <filesystem>
#include <memory>
#include <string>

#include "weft/io/animation.h"
#include "weft/run/past_run.h"
#include "weft/run/past_world.h"

namespace weft::engine {

/// The frames of a run, from its animation, or from its scene and point caches; of an unfinished run those so
/// far. They stay on disk. `path`: the folder of a run, or a .glb file of one. Throws InputError if it has
/// neither, or no cloth.
std::unique_ptr<FrameSource> open_frames(const std::filesystem::path& path);

/// Frames of particles, with the world that they are of.
struct FramesAndWorld {
  std::unique_ptr<PastWorld> world;     // null: `frames` are those of open_frames()
  std::string why_not;                  // there is no world, as a sentence
  std::unique_ptr<FrameSource> frames;  // refers to `world`
  PastCounts counts;
};

/// The frames with the world of the run's scene, if there is a scene with its files. Throws like open_frames().
FramesAndWorld open_frames_and_world(const std::filesystem::path& path);

/// The frame that is shown.
struct PlayHead {
  double frames_per_second = 60;  // > 0
  bool is_playing = true;
  bool loops = true;    // else it stops at the last frame
  double position = 0;  // in [0, number of frames) [frames]

  int frame() const { return static_cast<int>(position); }
  void advance(double seconds, int num_frames);  // if it is playing
  void play(int num_frames);                     // at the end of frames that do not loop: from the start
  void seek(int frame, int num_frames);          // to this one, or the nearest that there is
  void step(int count, int num_frames);          // pauses; count < 0: backwards
};

}  // namespace weft::engine
