/// Rollback: a network game corrects an input of ten frames ago, and replays.

#include <algorithm>
#include <deque>
#include <iostream>

#include "weft/weft.h"

namespace {

constexpr double kFrame = 1.0 / 60;

weft::World make_world() {
  weft::World world;
  const weft::Grid grid{.size_x = 0.6, .size_z = 0.6, .cells_x = 16, .cells_z = 16};
  const weft::ClothId sheet =
      world.add_cloth({.shape = grid, .pose = {{0, 0.3, -0.3}, weft::rotation_about({0, 0, 1}, -90)}});
  world.set_pins(sheet, {{.particles = {grid.index(0, 0), grid.index(0, 16)}}});
  world.add_collider({.name = "fist", .shape = weft::Sphere{.radius = 0.1}, .pose = {{-0.5, 0, 0}, {}}});
  return world;
}

/// One frame with the player's input: the position of the fist.
void play(weft::World& world, double x) {
  world.move_collider(world.collider(0), {{x, 0, 0}, {}});
  world.step(kFrame);
}

}  // namespace

int main() {
  const auto true_input = [](int frame) { return frame < 30 ? -0.5 + 0.015 * frame : -0.05; };

  // The player's machine, which has all inputs.
  weft::World player = make_world();
  for (int frame = 0; frame < 60; ++frame) play(player, true_input(frame));

  // The other machine receives them ten frames late: it predicts, and rolls back after a wrong prediction.
  constexpr int kDelay = 10;
  weft::World other = make_world();
  std::deque<weft::Snapshot> past;  // before each of the last frames
  double known = -0.5;
  int replayed = 0;
  for (int frame = 0; frame < 60 + kDelay; ++frame) {
    const int heard = frame - kDelay;
    if (heard >= 0 && heard < 60) {
      other.restore(past.front());
      past.clear();
      known = true_input(heard);
      for (int f = heard; f < std::min(frame, 60); ++f) {
        past.push_back(other.snapshot());
        play(other, f == heard ? known : true_input(heard));  // received, then predicted: unchanged
        ++replayed;
      }
      past.pop_front();
    }
    if (frame >= 60) continue;
    past.push_back(other.snapshot());
    play(other, known);
  }
  std::cout << replayed << " frames replayed; both machines "
            << (other.state_hash() == player.state_hash() ? "agree" : "differ") << "\n";
  return other.state_hash() == player.state_hash() ? 0 : 1;
}
