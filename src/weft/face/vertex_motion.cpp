#include "weft/face/vertex_motion.h"

#include "weft/error.h"
#include "weft/face/convert.h"

namespace weft {

int VertexMotion::num_vertices() const { return source_ ? source_->num_vertices() : 0; }
double VertexMotion::start() const { return source_ ? source_->start() : 0; }
double VertexMotion::end() const { return source_ ? source_->end() : 0; }

std::vector<Vec3> VertexMotion::positions(double time) const {
  std::vector<engine::Vec3> positions;
  if (source_) source_->evaluate(time, positions);
  return engine::from_engine(positions);
}

}  // namespace weft
