/// The distance to a sheet below a camera, with weft::pictures; needs no graphics.

#include <iostream>

#include "weft/pictures.h"
#include "weft/weft.h"

int main() {
  weft::World world;
  world.add_cloth({.shape = weft::Grid(), .fabric = weft::find_fabric("denim")});
  const weft::Camera camera{.position = {0.5, 2, 0.5}, .target = {0.5, 0, 0.5}, .width = 65, .height = 65};
  const weft::Rendering picture = weft::OffscreenRenderer().render(world, camera, {.color = false});
  std::cout << "depth: " << picture.depth[32 * 65 + 32] << " m\n";
}
