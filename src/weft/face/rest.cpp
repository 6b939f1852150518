#include <cmath>

#include "weft/error.h"
#include "weft/face/convert.h"
#include "weft/mesh.h"
#include "weft/mesh/rest_mesh.h"

namespace weft {

std::vector<TriangleCorners> rest_from_uv(const TriangleMesh& mesh, std::optional<double> scale) {
  if (mesh.uv.empty() || mesh.uv.size() != mesh.triangles.size())
    throw InputError("a rest shape from texture coordinates requires them for each triangle; the mesh has " +
                     std::to_string(mesh.triangles.size()) + " triangles, " + std::to_string(mesh.uv.size()) +
                     " with texture coordinates");
  if (scale && !(std::isfinite(*scale) && *scale > 0))
    throw InputError("the scale of texture coordinates must be above 0 m");
  std::vector<TriangleCorners> rest;
  double area_of_uv = 0, area = 0;
  for (const CornerUv& uv : mesh.uv) {
    TriangleCorners& corners = rest.emplace_back();
    for (int c = 0; c < 3; ++c) corners[c] = {uv[c][0], uv[c][1], 0};
  }
  const engine::RestMesh own = engine::to_engine(mesh);
  engine::require_valid(own);
  for (int t = 0; t < own.num_triangles(); ++t) {
    const auto [a, b, c] = rest[t];
    if (!engine::has_area({engine::to_engine(a), engine::to_engine(b), engine::to_engine(c)}) ||
        !engine::has_area(own.corners(t)))
      continue;
    area_of_uv += 0.5 * length(cross(b - a, c - a));
    area += engine::triangle_area(own, t);
  }
  if (!(area_of_uv > 0)) throw InputError("the texture coordinates of the mesh have no area");
  const double factor = scale.value_or(std::sqrt(area / area_of_uv));
  for (TriangleCorners& corners : rest) {
    for (Vec3& corner : corners) corner = {factor * corner.x, factor * corner.y, 0};
  }
  return rest;
}

}  // namespace weft
