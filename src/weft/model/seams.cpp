#include "weft/model/seams.h"

#include <algorithm>

namespace weft::engine {
namespace {

/// Lengths from the start of a stretch to each vertex [m].
std::vector<double> lengths_along(const TriangleMesh& mesh, std::span<const int> path) {
  std::vector<double> along = {0};
  for (std::size_t k = 1; k < path.size(); ++k)
    along.push_back(along.back() + (mesh.positions[path[k]] - mesh.positions[path[k - 1]]).norm());
  return along;
}

/// Springs from the vertices of one stretch to points of the other.
void add_springs(const TriangleMesh& mesh, std::span<const int> from, std::span<const int> to,
                 double stiffness, std::vector<SeamSpring>& springs) {
  const std::vector<double> own = lengths_along(mesh, from), other = lengths_along(mesh, to);
  const double seam = (own.back() + other.back()) / 2;
  std::size_t edge = 1;
  for (std::size_t k = 0; k < from.size(); ++k) {
    const double target = own[k] / own.back() * other.back();
    while (edge + 1 < to.size() && other[edge] < target) ++edge;
    const double share = std::clamp((target - other[edge - 1]) / (other[edge] - other[edge - 1]), 0.0, 1.0);
    SeamSpring spring{.particles = {from[k], to[edge - 1], to[edge]}, .share = share};
    if (spring.particles[share < 0.5 ? 1 : 2] == from[k]) continue;  // where the two stretches meet
    const std::size_t before = k == 0 ? k : k - 1, after = std::min(k + 1, from.size() - 1);
    spring.stiffness = stiffness * seam * (own[after] - own[before]) / (4 * own.back());
    const auto weights = spring.weights();
    Vec3 gap = Vec3::Zero();
    for (int c = 0; c < 3; ++c) gap += weights[c] * mesh.positions[spring.particles[c]];
    spring.start = gap.norm();
    springs.push_back(spring);
  }
}

}  // namespace

std::vector<SeamSpring> make_seam_springs(const TriangleMesh& mesh, std::span<const int> a,
                                          std::span<const int> b, double stiffness) {
  std::vector<SeamSpring> springs;
  add_springs(mesh, a, b, stiffness, springs);
  add_springs(mesh, b, a, stiffness, springs);
  return springs;
}

double mean_edge(const TriangleMesh& mesh, std::span<const int> a, std::span<const int> b) {
  return (lengths_along(mesh, a).back() + lengths_along(mesh, b).back()) /
         static_cast<double>(a.size() + b.size() - 2);
}

}  // namespace weft::engine
