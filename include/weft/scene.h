#pragma once
/// Scene files as worlds. Link weft::scene.

#include <string>
#include <vector>

#include "weft/export.h"
#include "weft/jobs.h"
#include "weft/world.h"

namespace weft {

/// A world as a scene file describes it, ready for its first step.
struct LoadedScene {
  World world = {};
  double frames_per_second = 60;
  int steps_per_frame = 1;
  int num_frames = 0;
  std::vector<std::string> warnings = {};  // about meshes, pins, colliders and the start, in sentences

  double step() const { return 1 / (frames_per_second * steps_per_frame); }  // length of a step [s]
};

/// Loads a scene file, or a shipped scene by its name ("drape_sphere"). `overrides` change single keys, as
/// `weft run --set` does: "cloth[0].fabric=denim". A start that crosses is put right unless the scene says
/// otherwise. Throws InputError with every mistake of the file at its line and column.
WEFT_API LoadedScene load_scene(const std::string& file_or_name,
                                const std::vector<std::string>& overrides = {});

/// A warning as a sentence, with the key of a scene file that helps: `cloth "sheet": …; raise solver.…`.
WEFT_API std::string describe(const World& world, const StepWarning& warning);

}  // namespace weft
