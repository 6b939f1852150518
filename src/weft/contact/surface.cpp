#include "weft/contact/surface.h"

#include <algorithm>
#include <tuple>

namespace weft::engine {

void Surface::add(const std::vector<Triangle>& mesh_triangles, int mesh_vertices) {
  struct Side {
    int a, b, triangle, corner;
  };
  std::vector<Side> sides;
  std::vector<char> is_owned(mesh_vertices, 0);
  for (const Triangle& local : mesh_triangles) {
    const int t = static_cast<int>(triangles.size());
    OwnedFeatures features;
    Triangle triangle;
    for (int k = 0; k < 3; ++k) {
      triangle[k] = local[k] + num_vertices;
      if (!is_owned[local[k]]) features.vertex[k] = triangle[k];
      is_owned[local[k]] = 1;
      const int a = local[k] + num_vertices, b = local[(k + 1) % 3] + num_vertices;
      sides.push_back({std::min(a, b), std::max(a, b), t, k});
    }
    triangles.push_back(triangle);
    owned.push_back(features);
  }
  std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) {
    return std::tie(x.a, x.b, x.triangle, x.corner) < std::tie(y.a, y.b, y.triangle, y.corner);
  });
  for (std::size_t s = 0; s < sides.size(); ++s) {
    if (s > 0 && sides[s].a == sides[s - 1].a && sides[s].b == sides[s - 1].b) continue;
    owned[sides[s].triangle].edge[sides[s].corner] = static_cast<int>(edges.size());
    edges.push_back({sides[s].a, sides[s].b});
  }
  num_vertices += mesh_vertices;
}

void Surface::build_one_rings() {
  one_ring_begin.assign(num_vertices + 1, 0);
  for (const Triangle& t : triangles) {
    for (const int v : t) ++one_ring_begin[v + 1];
  }
  for (int v = 0; v < num_vertices; ++v) one_ring_begin[v + 1] += one_ring_begin[v];
  one_ring.resize(one_ring_begin[num_vertices]);
  std::vector<int> next(one_ring_begin.begin(), one_ring_begin.end() - 1);
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
    for (const int v : triangles[t]) one_ring[next[v]++] = t;
  }
}

int num_shared_vertices(const Triangle& a, const Triangle& b) {
  return static_cast<int>(std::count_if(a.begin(), a.end(), [&](int v) { return has_vertex(b, v); }));
}

int mesh_of(const std::vector<int>& first_vertex, int vertex) {
  return static_cast<int>(std::upper_bound(first_vertex.begin(), first_vertex.end(), vertex) -
                          first_vertex.begin()) -
         1;
}

}  // namespace weft::engine
