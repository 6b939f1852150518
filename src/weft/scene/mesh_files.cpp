/// Public functions for reading and writing mesh files.

#include <cmath>
#include <memory>

#include "weft/error.h"
#include "weft/face/convert.h"
#include "weft/face/vertex_motion.h"
#include "weft/io.h"
#include "weft/io/gltf_body.h"
#include "weft/io/obj_reader.h"

namespace weft {

MeshFromFile read_obj(const std::string& file) {
  engine::MeshFromFile obj = engine::read_obj(file);
  return {engine::from_engine(obj.mesh, obj.uv), std::move(obj.warnings)};
}

BodyFromFile read_gltf(const std::string& file, const GltfOptions& options) {
  if (!(std::isfinite(options.scale) && options.scale > 0))
    throw InputError(file + ": the scale must be above 0");
  engine::GltfBody body = engine::read_gltf_body(file, options);
  const engine::MeshFromFile start = mesh_at_start(body);
  BodyFromFile result{.mesh = engine::from_engine(start.mesh, start.uv),
                      .clip = std::move(body.clip),
                      .warnings = std::move(body.warnings)};
  if (!body.vertices.is_still())
    result.motion =
        VertexMotionAccess::make(std::make_shared<const engine::SkinnedMesh>(std::move(body.vertices)));
  return result;
}

void write_obj(const std::string& file, const TriangleMesh& mesh) {
  engine::write_obj(file, engine::to_engine(mesh), engine::to_engine(mesh.uv));
}

}  // namespace weft
