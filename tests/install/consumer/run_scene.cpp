/// Two frames of a shipped scene through the public headers; prints the state's hash.

#include <cstdio>

#include "weft/scene.h"

int main() {
  weft::LoadedScene scene = weft::load_scene(SCENE);
  for (int step = 0; step < 2 * scene.steps_per_frame; ++step) scene.world.step(scene.step());
  std::printf("{\"state_hash\": \"%016llx\"}\n", static_cast<unsigned long long>(scene.world.state_hash()));
}
