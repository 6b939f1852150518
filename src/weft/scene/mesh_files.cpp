/// Public functions for reading and writing mesh files.

#include "weft/face/convert.h"
#include "weft/io.h"
#include "weft/io/obj_reader.h"

namespace weft {

MeshFromFile read_obj(const std::string& file) {
  engine::MeshFromFile obj = engine::read_obj(file);
  return {engine::from_engine(obj.mesh, obj.uv), std::move(obj.warnings)};
}

void write_obj(const std::string& file, const TriangleMesh& mesh) {
  engine::write_obj(file, engine::to_engine(mesh), engine::to_engine(mesh.uv));
}

}  // namespace weft
