#pragma once
/// Frames of a run that are shown again, in their time.

#include <filesystem>
#include <memory>

#include "weft/io/animation.h"
#include "weft/run/past_run.h"

namespace weft::engine {

/// The frames of a run, from its animation; of an unfinished run those so far. They stay on disk. `path`: the
/// folder of a run, or a .glb file of one. Throws InputError if it has no animation, or that has no cloth.
std::unique_ptr<FrameSource> open_frames(const std::filesystem::path& path);

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
