#include "weft/scene/scene_start.h"

#include <algorithm>

#include "weft/core/nearest_name.h"
#include "weft/error.h"
#include "weft/face/convert.h"
#include "weft/face/world_impl.h"

namespace weft::engine {
namespace {

void set_start(const ClothStart& start, const std::string& source, ClothId cloth, weft::World& world) {
  const ClothNotes& notes = world.notes(cloth);
  const std::size_t count = notes.particle_of_vertex.size();
  if (start.positions.size() != count)
    throw InputError("cloth \"" + start.cloth + "\" has " + std::to_string(count) +
                     " vertices in the scene, but " + std::to_string(start.positions.size()) + " in " +
                     source + "; a start requires the same mesh");
  const RestShape& rest = WorldAccess::rest(world, cloth);
  world.set_positions(cloth, from_engine(to_particles(start.positions, rest, notes)));
  world.set_velocities(cloth, from_engine(to_particles(start.velocities, rest, notes)));
}

}  // namespace

void set_start(const SceneStart& start, PublicScene& built) {
  std::vector<std::string> names, old_names, own;
  for (int c = 0; c < built.world.num_cloths(); ++c) {
    const ClothId cloth = built.world.cloth(c);
    const std::string name = built.world.name(cloth);
    names.push_back(name);
    const auto found = std::ranges::find(start.cloths, name, &ClothStart::cloth);
    if (found == start.cloths.end()) {
      own.push_back(name);
      continue;
    }
    set_start(*found, start.source, cloth, built.world);
    built.notes.push_back("cloth \"" + name + "\" starts from " + start.source);
  }
  for (const ClothStart& old : start.cloths) {
    old_names.push_back(old.cloth);
    if (std::ranges::find(names, old.cloth) == names.end())
      built.notes.push_back("cloth \"" + old.cloth + "\" of " + start.source + " is not in the scene");
  }
  for (const std::string& name : own)
    built.notes.push_back("cloth \"" + name + "\" starts as the scene says: it is not in " + start.source);
  if (own.size() == names.size())
    throw InputError("no cloth starts from " + start.source + ": the scene has " +
                     list_names(names, names.size()) + ", the run has " +
                     list_names(old_names, old_names.size()) + "; cloths are matched by name");
}

}  // namespace weft::engine
