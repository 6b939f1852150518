/// .glb files: any bytes become an animation or an InputError.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "make_glb.h"
#include "weft/error.h"
#include "weft/io/glb_reader.h"

namespace {

void parse(const std::vector<unsigned char>& bytes) {
  try {
    weft::engine::parse_glb(bytes, "fuzz.glb");
  } catch (const weft::InputError&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  parse({data, data + size});
  parse(make_glb(data, size));
  return 0;
}
