#include "weft/run/past_world.h"

#include "weft/face/build_cloth.h"
#include "weft/face/world_impl.h"

namespace weft::engine {
namespace {

std::vector<Vec3> to_points(const std::vector<float>& numbers) {
  std::vector<Vec3> points;
  points.reserve(numbers.size() / 3);
  for (std::size_t k = 0; k < numbers.size(); k += 3)
    points.emplace_back(numbers[k], numbers[k + 1], numbers[k + 2]);
  return points;
}

}  // namespace

const World& PastWorld::world() const { return WorldAccess::engine(world_); }

std::vector<float> PastWorld::to_particles(int cloth, const std::vector<float>& vertices) const {
  const ClothId id = world_.cloth(cloth);
  if (world().can_tear(id)) return vertices;
  const std::vector<Vec3> points =
      engine::to_particles(to_points(vertices), WorldAccess::rest(world_, id), world_.notes(id));
  std::vector<float> numbers;
  numbers.reserve(3 * points.size());
  for (const Vec3& point : points) {
    for (const double c : point) numbers.push_back(static_cast<float>(c));
  }
  return numbers;
}

void PastWorld::set_time(double time) { WorldAccess::engine(world_).set_time(time); }

AnimationFrame PastWorld::show(FrameSource& frames, int number) {
  World& world = WorldAccess::engine(world_);
  AnimationFrame now = frames.read(number);
  const std::vector<std::vector<float>> before = number > 0 ? frames.read(number - 1).cloths : now.cloths;
  const double rate = frames.meshes().frames_per_second;
  for (int c = 0; c < world.num_cloths(); ++c) {
    const std::vector<Vec3> positions = to_points(now.cloths[c]);
    std::vector<Vec3> velocities = to_points(before[c]);
    for (std::size_t i = 0; i < positions.size(); ++i) velocities[i] = rate * (positions[i] - velocities[i]);
    world.set_positions(world.cloth(c), positions);
    world.set_velocities(world.cloth(c), velocities);
  }
  world.set_time(number / rate);
  return now;
}

AnimationFrame FramesWithValues::read(int number) {
  AnimationFrame frame = world_.show(frames_, number);
  const World& world = world_.world();
  for (int c = 0; c < world.num_cloths(); ++c)
    frame.values.push_back(compute_values(value_, world, world.cloth(c)));
  return frame;
}

}  // namespace weft::engine
