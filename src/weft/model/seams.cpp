#include "weft/model/seams.h"

#include <algorithm>
#include <utility>

namespace weft::engine {
namespace {

/// Lengths at rest from the start of a stretch of border to each vertex [m].
std::vector<double> lengths_along(const RestMesh& mesh, std::span<const int> path) {
  const std::vector<Edge> edges = mesh.at_rest.empty() ? std::vector<Edge>() : build_edges(mesh);
  const auto length = [&](int a, int b) {
    if (edges.empty()) return (mesh.positions[a] - mesh.positions[b]).norm();
    const std::pair<int, int> ends = std::minmax(a, b);
    const auto ends_of = [](const Edge& e) { return std::pair(e.a, e.b); };
    return edge_length(mesh, *std::ranges::lower_bound(edges, ends, {}, ends_of));
  };
  std::vector<double> along = {0};
  for (std::size_t k = 1; k < path.size(); ++k) along.push_back(along.back() + length(path[k], path[k - 1]));
  return along;
}

/// Springs from the vertices of one stretch to points of the other; `own` and `other` are their lengths_along().
void add_springs(const RestMesh& mesh, std::span<const int> from, const std::vector<double>& own,
                 std::span<const int> to, const std::vector<double>& other, double stiffness,
                 std::vector<SeamSpring>& springs) {
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

std::vector<SeamSpring> make_seam_springs(const RestMesh& mesh, std::span<const int> a,
                                          std::span<const int> b, double stiffness) {
  const std::vector<double> along_a = lengths_along(mesh, a), along_b = lengths_along(mesh, b);
  std::vector<SeamSpring> springs;
  add_springs(mesh, a, along_a, b, along_b, stiffness, springs);
  add_springs(mesh, b, along_b, a, along_a, stiffness, springs);
  return springs;
}

std::vector<SeamSpring> make_stitches(const RestMesh& mesh, std::span<const std::array<int, 2>> pairs,
                                      std::optional<double> stiffness, double of_edges) {
  struct Around {
    double border = 0, all = 0;  // sums of edges [m]
    int num_edges = 0;
    int neighbour = -1;

    double length() const { return border > 0 ? border / 2 : all / num_edges; }
  };
  std::vector<Around> around(mesh.positions.size());
  for (const Edge& e : build_edges(mesh)) {
    const double length = edge_length(mesh, e);
    for (const auto& [own, other] : {std::pair(e.a, e.b), std::pair(e.b, e.a)}) {
      around[own].all += length;
      if (e.num_triangles == 1) around[own].border += length;
      ++around[own].num_edges;
      around[own].neighbour = other;
    }
  }
  std::vector<SeamSpring> springs;
  double total = 0;
  for (const auto& [a, b] : pairs) {
    if (a == b) continue;
    const double length = (around[a].length() + around[b].length()) / 2;
    springs.push_back({.particles = {a, b, around[b].neighbour},
                       .start = (mesh.positions[a] - mesh.positions[b]).norm(),
                       .stiffness = length});
    total += length;
  }
  const double per_length =
      springs.empty() ? 0 : stiffness.value_or(of_edges * static_cast<double>(springs.size()) / total);
  for (SeamSpring& spring : springs) spring.stiffness *= per_length;
  return springs;
}

double mean_edge(const RestMesh& mesh, std::span<const int> a, std::span<const int> b) {
  return (lengths_along(mesh, a).back() + lengths_along(mesh, b).back()) /
         static_cast<double>(a.size() + b.size() - 2);
}

}  // namespace weft::engine
