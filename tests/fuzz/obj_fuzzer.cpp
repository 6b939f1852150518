/// OBJ files: any bytes become a clean mesh or an InputError.

#include <cstddef>
#include <cstdint>
#include <string>

#include "weft/error.h"
#include "weft/io/obj_reader.h"
#include "weft/mesh/clean.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    const weft::engine::MeshFromFile obj = weft::engine::parse_obj(text, "fuzz.obj");
    weft::engine::clean_mesh(obj.mesh);
    weft::engine::clean_mesh(obj.mesh, {.weld_distance = 1e-3});
  } catch (const weft::InputError&) {
  }
  return 0;
}
