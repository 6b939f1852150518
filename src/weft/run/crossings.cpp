/// Public functions: intersections of surfaces.

#include "weft/mesh.h"

#include <cmath>
#include <string>

#include "weft/error.h"
#include "weft/face/convert.h"
#include "weft/verify/crossings.h"

namespace weft {
namespace {

void require_valid(const Surface& surface, std::size_t index) {
  const std::string who = "surface " + std::to_string(index) + ": ";
  const auto count = static_cast<int>(surface.positions.size());
  for (const Triangle& triangle : surface.triangles)
    for (const int vertex : triangle)
      if (vertex < 0 || vertex >= count)
        throw InputError(who + "there is no vertex " + std::to_string(vertex) + "; it has " +
                         std::to_string(count));
  for (int v = 0; v < count; ++v)
    for (const double number : {surface.positions[v].x, surface.positions[v].y, surface.positions[v].z})
      if (!std::isfinite(static_cast<float>(number)))
        throw InputError(who + "the position of vertex " + std::to_string(v) + " is not a finite number");
}

}  // namespace

std::vector<Crossing> find_crossings(const std::vector<Surface>& surfaces) {
  std::vector<std::vector<engine::Vec3>> positions;
  std::vector<engine::verify::SurfaceView> views;
  positions.reserve(surfaces.size());
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    require_valid(surfaces[s], s);
    positions.push_back(engine::to_engine(surfaces[s].positions));
    views.push_back({positions.back(), surfaces[s].triangles, surfaces[s].is_cloth});
  }
  std::vector<Crossing> found;
  for (const engine::verify::Crossing& c : engine::verify::find_crossings(views))
    found.push_back({c.a.surface, c.a.triangle, c.b.surface, c.b.triangle});
  return found;
}

}  // namespace weft
