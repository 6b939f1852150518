/// PLY files: any bytes become a valid mesh or an InputError. Mesh cleaning is a part of obj_fuzzer.cpp.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "weft/error.h"
#include "weft/io/ply.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  weft::engine::MeshFromFile read;
  try {
    read = weft::engine::parse_ply(bytes, "fuzz.ply");
  } catch (const weft::InputError&) {
    return 0;
  }
  weft::engine::require_valid(read.mesh);  // its error ends the program
  if (!read.uv.empty() && read.uv.size() != read.mesh.triangles.size()) std::abort();
  return 0;
}
