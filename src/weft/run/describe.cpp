/// Public functions: warnings as text.

#include "weft/face/world_impl.h"
#include "weft/run/warnings.h"
#include "weft/scene.h"

namespace weft {

std::string describe(const World& world, const StepWarning& warning) {
  return engine::describe(WorldAccess::engine(world), warning);
}

}  // namespace weft
