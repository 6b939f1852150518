/// Saved worlds: any bytes become a world that can step, or an InputError. The input is a list of edits of a
/// saved world, three bytes each: position and value. The checksum is recomputed afterwards.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "weft/weft.h"

namespace {

std::vector<std::byte> make_bytes() {
  weft::World world;
  const weft::ClothId cloth = world.add_cloth({.shape = weft::Grid{.cells_x = 2, .cells_z = 2}});
  world.set_pins(cloth, {{.particles = {0}, .motion = {{0, {}, {}}, {1, {0, 1, 0}, {}}}},
                         {.particles = {1}, .stiffness = 1.0}});
  world.add_cloth(
      {.shape = weft::TriangleMesh{.positions = {{0, 1, 0}, {1, 1, 0}, {0, 1, 1}}, .triangles = {{0, 2, 1}}},
       .fabric = weft::Springs{}});
  const weft::ColliderId body =
      world.add_collider({.shape = weft::TriangleMesh{.positions = {{0, -9, 0}, {1, -9, 0}, {0, -9, 1}},
                                                      .triangles = {{0, 2, 1}}}});
  world.move_vertices(body, {{0, -8, 0}, {1, -9, 0}, {0, -9, 1}});
  world.step(1.0 / 60);
  return world.save();
}

/// Sets the last eight bytes to FNV-1a over all others.
void seal(std::vector<std::byte>& bytes) {
  std::uint64_t sum = 0xcbf29ce484222325ULL;
  for (std::size_t i = 0; i + 8 < bytes.size(); ++i)
    sum = (sum ^ static_cast<std::uint64_t>(bytes[i])) * 0x100000001b3ULL;
  for (std::size_t b = 0; b < 8; ++b) bytes[bytes.size() - 8 + b] = static_cast<std::byte>(sum >> (8 * b));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<std::byte> original = make_bytes();
  std::vector<std::byte> bytes = original;
  for (std::size_t e = 0; e + 3 <= size; e += 3)
    bytes[static_cast<std::size_t>(data[e] | data[e + 1] << 8) % bytes.size()] =
        static_cast<std::byte>(data[e + 2]);
  seal(bytes);
  try {
    weft::World::load(bytes).step(1.0 / 60);
  } catch (const weft::InputError&) {
  }
  return 0;
}
