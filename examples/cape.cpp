/// A cape on a walking figure of capsules: pin targets per frame for its collar, and a teleport of both.

#include <cmath>
#include <iostream>
#include <vector>

#include "weft/weft.h"

namespace {

constexpr double kFrame = 1.0 / 60;
constexpr int kCells = 24;

/// Pose of the figure at a time: it walks along z and sways.
weft::Pose body_at(double time, double start_z) {
  return {{0.03 * std::sin(6 * time), 0, start_z + 1.2 * time},
          weft::rotation_about({0, 1, 0}, 8 * std::sin(6 * time))};
}

}  // namespace

int main() {
  weft::World world;
  const std::vector<weft::Capsule> parts = {{.a = {0, 0.9, 0}, .b = {0, 1.35, 0}, .radius = 0.14},
                                            {.a = {-0.18, 1.4, 0}, .b = {0.18, 1.4, 0}, .radius = 0.07},
                                            {.a = {0, 1.62, 0}, .b = {0, 1.7, 0}, .radius = 0.1}};
  std::vector<weft::ColliderId> body;
  for (const weft::Capsule& part : parts) body.push_back(world.add_collider({.shape = part}));

  // The cape hangs behind the shoulders; its first row is the collar.
  const weft::Grid grid{.size_x = 0.5, .size_z = 0.9, .cells_x = kCells, .cells_z = 2 * kCells};
  const weft::ClothId cape =
      world.add_cloth({.name = "cape",
                       .shape = grid,
                       .fabric = weft::find_fabric("silk"),
                       .pose = {{-0.25, 1.45, -0.16}, weft::rotation_about({1, 0, 0}, 90)}});
  weft::Pin collar;
  std::vector<weft::Vec3> on_body;  // in the figure's coordinates
  for (int i = 0; i <= kCells; i += 2) {
    collar.particles.push_back(grid.index(i, 0));
    on_body.push_back(world.positions(cape)[grid.index(i, 0)]);
  }
  world.set_pins(cape, {collar});

  double start_z = 0;
  for (int frame = 1; frame <= 180; ++frame) {
    if (frame == 120) {  // the level ends: back by three metres, cape and figure alike
      start_z -= 3;
      world.teleport(cape, {{0, 0, -3}, {}});
      for (const weft::ColliderId part : body)
        world.place_collider(part, body_at((frame - 1) * kFrame, start_z));
    }
    const weft::Pose pose = body_at(frame * kFrame, start_z);
    for (const weft::ColliderId part : body) world.move_collider(part, pose);
    std::vector<weft::Vec3> targets;
    for (const weft::Vec3& p : on_body) targets.push_back(pose.rotation * p + pose.translation);
    world.move_pins(cape, targets);
    if (!world.step(kFrame).ok) return 1;
  }
  const double behind = start_z + 1.2 * 3 - world.center_of_mass(cape).z;
  std::cout << "the cape flies " << behind << " m behind the shoulders\n";
  return behind > 0.1 && behind < 0.9 ? 0 : 1;
}
