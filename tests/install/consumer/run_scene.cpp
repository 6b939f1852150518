/// Two frames of a shipped scene, and the report of the run.

#include <iostream>

#include "weft/run/runner.h"
#include "weft/scene/scene_reader.h"

int main() {
  const weft::SceneDesc scene = weft::read_scene(SCENE);
  std::cout << weft::to_json(weft::run_scene(scene, {.frames = 2}).report);
}
