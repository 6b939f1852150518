/// A gripper takes a towel off a rail: two jaws and a rail, moved by the program frame by frame.

#include <algorithm>
#include <iostream>

#include "weft/weft.h"

namespace {

constexpr double kFrame = 1.0 / 60;
constexpr double kJaw = 0.01;  // half the thickness of a jaw [m]

/// Linear ramp from 0 to 1 between two times.
double ramp(double time, double start, double end) {
  return std::clamp((time - start) / (end - start), 0.0, 1.0);
}

}  // namespace

int main() {
  weft::World world;
  world.add_collider({.name = "floor", .shape = weft::Plane{}});
  const weft::ColliderId rail = world.add_collider(
      {.name = "rail", .shape = weft::Capsule{.a = {0, 0.5, -0.3}, .b = {0, 0.5, 0.3}, .radius = 0.01}});

  // The towel starts on the rail and falls over it on both sides.
  const weft::Grid grid{.size_x = 0.5, .size_z = 0.3, .cells_x = 40, .cells_z = 24};
  const weft::ClothId towel = world.add_cloth({.name = "towel",
                                               .shape = grid,
                                               .fabric = weft::find_fabric("cotton_shirting"),
                                               .pose = {{-0.25, 0.512, -0.15}, {}}});

  const weft::OrientedBox jaw{.half_size = {kJaw, 0.03, 0.1}};
  const auto add_jaw = [&](const char* name, double x) {
    return world.add_collider({.name = name, .shape = jaw, .pose = {{x, 0.4, 0}, {}}, .friction = 1});
  };
  const weft::ColliderId left = add_jaw("left", -0.3), right = add_jaw("right", 0.3);

  for (int frame = 1; frame <= 240; ++frame) {
    const double time = frame * kFrame;
    // Both layers of the towel are between the jaws: closed, these leave less than twice its thickness.
    const double gap = kJaw + 0.29 - 0.2895 * ramp(time, 1.0, 2.0);
    const double lift = 0.3 * ramp(time, 2.5, 3.5);
    world.move_collider(left, {{-gap, 0.4 + lift, 0}, {}});
    world.move_collider(right, {{gap, 0.4 + lift, 0}, {}});
    world.move_collider(rail, {{0, 0, 0.8 * ramp(time, 2.0, 2.5)}, {}});  // pulled out sideways
    if (!world.step(kFrame).ok) return 1;
  }
  const double height = world.center_of_mass(towel).y;
  std::cout << "the towel hangs at " << height << " m\n";
  return height > 0.5 ? 0 : 1;
}
