/// Hello cloth: a square metre of denim, hung by two corners and released.

#include <iostream>

#include "weft/weft.h"

int main() {
  weft::World world;
  const weft::Grid grid{.size_x = 1, .size_z = 1, .cells_x = 32, .cells_z = 32};
  const weft::ClothId cloth = world.add_cloth({.shape = grid, .fabric = weft::find_fabric("denim")});
  world.set_pins(cloth, {{.particles = {grid.index(0, 0), grid.index(32, 0)}}});
  for (int frame = 0; frame < 120; ++frame) {
    const weft::StepReport report = world.step(1.0 / 60);
    if (!report.ok) return 1;
  }
  const weft::Vec3 center = world.center_of_mass(cloth);
  std::cout << "after two seconds its centre is at y = " << center.y << " m\n";
  return center.y < -0.1 ? 0 : 1;
}
