/// Contact forces: the share of a towel's weight on each of two rails.

#include <iostream>

#include "weft/weft.h"

int main() {
  weft::World world;
  world.set_contact({.tracks_points = true});
  const auto add_rail = [&](double x) {
    return world.add_collider(
        {.shape = weft::Capsule{.a = {x, 0, -0.5}, .b = {x, 0, 0.5}, .radius = 0.02}, .friction = 0.6});
  };
  const weft::ColliderId left = add_rail(0.15), right = add_rail(0.35);

  const weft::Grid grid{.size_x = 0.5, .size_z = 0.4, .cells_x = 30, .cells_z = 24};
  const weft::ClothId towel = world.add_cloth(
      {.shape = grid, .fabric = weft::find_fabric("cotton_shirting"), .pose = {{0, 0.022, -0.2}, {}}});
  double on_left = 0, on_right = 0;  // means over the last second [N]
  for (int frame = 0; frame < 240; ++frame) {
    if (!world.step(1.0 / 60).ok) return 1;
    if (frame < 180) continue;
    for (const weft::ContactPoint& contact : world.contact_points()) {
      if (contact.collider == left) on_left += contact.force.y / 60;
      if (contact.collider == right) on_right += contact.force.y / 60;
    }
  }
  double weight = 0;
  for (const double mass : world.masses(towel)) weight += 9.81 * mass;
  std::cout << "the rails bear " << on_left << " N and " << on_right << " N of " << weight << " N\n";
  return std::abs(on_left + on_right - weight) < 0.05 * weight ? 0 : 1;
}
