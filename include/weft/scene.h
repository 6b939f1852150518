#pragma once
/// Scene files, loaded as worlds. Link weft::scene.

#include <string>
#include <vector>

#include "weft/export.h"
#include "weft/jobs.h"
#include "weft/world.h"

namespace weft {

/// A world built from a scene file, ready for its first step.
struct LoadedScene {
  World world = {};
  double frames_per_second = 60;
  int steps_per_frame = 1;
  int num_frames = 0;
  std::vector<std::string> warnings = {};  // on meshes, pins, colliders and the start, as sentences

  double step() const { return 1 / (frames_per_second * steps_per_frame); }  // length of a step [s]
};

/// Loads a scene file, or a shipped scene by its name ("drape_sphere"). `overrides` change single keys, as
/// `weft run --set` does: "cloth[0].fabric=denim". Intersections at the start are repaired unless the scene
/// says otherwise. Throws InputError with every mistake of the file, with line and column.
WEFT_API LoadedScene load_scene(const std::string& file_or_name,
                                const std::vector<std::string>& overrides = {});

/// A warning as a sentence, with the scene file key that helps: `cloth "sheet": …; raise solver.…`.
WEFT_API std::string describe(const World& world, const StepWarning& warning);

}  // namespace weft
