/// Public functions: problems of a world, and warnings as text.

#include "weft/face/world_impl.h"
#include "weft/run/problems.h"
#include "weft/run/warnings.h"
#include "weft/scene.h"

namespace weft {

std::string describe(const World& world, const StepWarning& warning) {
  return engine::describe(WorldAccess::engine(world), warning);
}

std::vector<StepWarning> find_problems(const World& world) {
  return engine::find_problems(WorldAccess::engine(world));
}

}  // namespace weft
