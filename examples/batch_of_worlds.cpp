/// 64 worlds in parallel: a towel thrown at a bar at 64 speeds, as for a data set.

#include <iostream>

#include "weft/weft.h"

int main() {
  weft::World first;
  first.add_collider({.name = "bar",
                      .shape = weft::Capsule{.a = {0, 0, -1}, .b = {0, 0, 1}, .radius = 0.03},
                      .friction = 0.8});
  const weft::Grid grid{.size_x = 0.5, .size_z = 0.3, .cells_x = 15, .cells_z = 9};
  const weft::ClothId towel = first.add_cloth({.shape = grid, .pose = {{-0.25, 0.1, -0.15}, {}}});

  weft::WorldBatch batch(weft::make_jobs(2));
  for (int n = 0; n < 64; ++n) {
    weft::World world = first.clone();  // accepts the ids of the original
    const double speed = 0.05 * n;
    world.set_velocities(
        towel, std::vector<weft::Vec3>(static_cast<std::size_t>(grid.num_particles()), {speed, 0, 0}));
    batch.add(std::move(world));
  }
  for (int frame = 0; frame < 60; ++frame) batch.step(1.0 / 60);

  int caught = 0;
  for (int n = 0; n < batch.size(); ++n) caught += batch[n].center_of_mass(towel).y > -0.5;
  std::cout << caught << " of 64 towels hang on the bar\n";
  return caught > 5 && caught < 60 ? 0 : 1;
}
