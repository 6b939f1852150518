/// glTF files of any origin: any bytes become a body, which can be evaluated at any time, or an InputError.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <vector>

#include "make_glb.h"
#include "weft/error.h"
#include "weft/io/gltf_body.h"

namespace {

void parse(const std::vector<unsigned char>& bytes) {
  using namespace weft::engine;
  try {
    const GltfBody body = parse_gltf_body(bytes, "fuzz.glb");
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const double start = body.vertices.start(), end = body.vertices.end();
    std::vector<Vec3> positions;
    for (const double time : {-kInfinity, start, 0.7 * start + 0.3 * end, end, kInfinity})
      body.vertices.evaluate(time, positions);
    for (const weft::Triangle& triangle : body.triangles) {
      for (const int v : triangle) {
        if (v < 0 || v >= static_cast<int>(positions.size())) std::abort();
      }
    }
  } catch (const weft::InputError&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  parse({data, data + size});
  parse(make_glb(data, size));
  return 0;
}
