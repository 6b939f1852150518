/// A game loop: fixed time steps, rendering at any time, positions and normals in a vertex buffer.

#include <algorithm>
#include <iostream>
#include <vector>

#include "weft/weft.h"

namespace {

struct Vertex {
  float position[3];
  float normal[3];
};

/// Two states of the cloth, and interpolation between them.
class ClothRenderer {
 public:
  ClothRenderer(const weft::World& world, weft::ClothId cloth) : world_(world), cloth_(cloth) {
    const auto count = static_cast<std::size_t>(world.num_particles(cloth));
    before_.resize(count);
    after_.resize(count);
    buffer_.resize(count);
    read();
    before_ = after_;
  }

  /// Call after every step.
  void read() {
    before_.swap(after_);
    world_.copy_positions(cloth_, after_[0].position, sizeof(Vertex));
    world_.copy_normals(cloth_, after_[0].normal, sizeof(Vertex));
  }

  /// Interpolates by `share` between the last two states; an engine would upload the result.
  const std::vector<Vertex>& draw(float share) {
    for (std::size_t i = 0; i < buffer_.size(); ++i) {
      for (int c = 0; c < 3; ++c) {
        const float a = before_[i].position[c], b = after_[i].position[c];
        buffer_[i].position[c] = a + share * (b - a);
        buffer_[i].normal[c] = after_[i].normal[c];
      }
    }
    return buffer_;
  }

 private:
  const weft::World& world_;
  weft::ClothId cloth_;
  std::vector<Vertex> before_, after_, buffer_;
};

}  // namespace

int main() {
  weft::World world;
  const weft::Grid grid{.cells_x = 24, .cells_z = 24};
  const weft::ClothId flag = world.add_cloth({.shape = grid, .fabric = weft::find_fabric("silk")});
  world.set_pins(flag, {{.particles = {grid.index(0, 0), grid.index(0, 12), grid.index(0, 24)}}});
  world.set_wind({.velocity = {5, 0, 1}, .air = {.density = 1.2}, .gusts = {.strength = 1.5}});
  ClothRenderer renderer(world, flag);

  constexpr double kStep = 1.0 / 60;
  double waiting = 0, lowest = 0;
  for (int picture = 0; picture < 288; ++picture) {  // two seconds at 144 pictures per second
    waiting += 1.0 / 144;
    while (waiting >= kStep) {
      if (!world.step(kStep).ok) return 1;
      renderer.read();
      waiting -= kStep;
    }
    for (const Vertex& v : renderer.draw(static_cast<float>(waiting / kStep)))
      lowest = std::min<double>(lowest, v.position[1]);
  }
  std::cout << "the lowest vertex drawn was at " << lowest << " m\n";
  return lowest < -0.2 ? 0 : 1;
}
