#include "weft/mesh/soup.h"

#include <map>
#include <tuple>

namespace weft::engine {

std::vector<Triangle> make_soup(int num_triangles) {
  std::vector<Triangle> triangles;
  for (int t = 0; t < num_triangles; ++t) triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  return triangles;
}

bool is_soup(const std::vector<Triangle>& triangles) {
  int next = 0;
  for (const Triangle& t : triangles) {
    for (const int v : t) {
      if (v != next++) return false;
    }
  }
  return true;
}

std::vector<Triangle> join_soup(const std::vector<Triangle>& triangles, std::span<const float> positions) {
  std::map<std::tuple<float, float, float>, int> first;
  std::vector<Triangle> joined = triangles;
  for (Triangle& t : joined) {
    for (int& v : t) {
      const float* p = &positions[3 * static_cast<std::size_t>(v)];
      v = first.try_emplace({p[0], p[1], p[2]}, v).first->second;
    }
  }
  return joined;
}

}  // namespace weft::engine
