#include "weft/mesh/loop_subdivision.h"

#include <map>

#include "weft/core/angle.h"

namespace weft::engine {
namespace {

using Row = std::map<int, double>;  // weight of each vertex

/// Neighbours of each vertex: along its border if it lies on one, else all.
struct Surroundings {
  std::vector<int> around, along_border;
};

std::vector<Surroundings> find_surroundings(const std::vector<Edge>& edges, int num_vertices) {
  std::vector<Surroundings> surroundings(num_vertices);
  for (const Edge& edge : edges) {
    for (const auto& [from, to] : {std::pair(edge.a, edge.b), std::pair(edge.b, edge.a)}) {
      surroundings[from].around.push_back(to);
      if (edge.num_triangles != 2) surroundings[from].along_border.push_back(to);
    }
  }
  return surroundings;
}

Row place_vertex(int vertex, const Surroundings& s) {
  if (s.along_border.size() == 2)
    return {{vertex, 0.75}, {s.along_border[0], 0.125}, {s.along_border[1], 0.125}};
  if (!s.along_border.empty() || s.around.empty()) return {{vertex, 1.0}};
  const double n = static_cast<double>(s.around.size());
  const double c = 3.0 / 8 + sin_cos_deg(360 / n).cos / 4;
  const double weight = (5.0 / 8 - c * c) / n;
  Row row = {{vertex, 1 - n * weight}};
  for (const int neighbour : s.around) row[neighbour] += weight;
  return row;
}

Row place_on(const Edge& edge) {
  if (edge.num_triangles != 2) return {{edge.a, 0.5}, {edge.b, 0.5}};
  Row row = {{edge.a, 3.0 / 8}, {edge.b, 3.0 / 8}};
  for (const int vertex : edge.opposite) row[vertex] += 1.0 / 8;
  return row;
}

/// One level: rows of the finer mesh's vertices, and its triangles.
struct Level {
  std::vector<Row> rows;
  std::vector<Triangle> triangles;
};

Level divide(const std::vector<Triangle>& triangles, int num_vertices) {
  TriangleMesh mesh;
  mesh.positions.resize(num_vertices);
  mesh.triangles = triangles;
  const std::vector<Edge> edges = build_edges(mesh);
  const std::vector<Surroundings> surroundings = find_surroundings(edges, num_vertices);
  Level level;
  for (int v = 0; v < num_vertices; ++v) level.rows.push_back(place_vertex(v, surroundings[v]));
  std::map<std::pair<int, int>, int> middles;
  for (const Edge& edge : edges) {
    middles[{edge.a, edge.b}] = static_cast<int>(level.rows.size());
    level.rows.push_back(place_on(edge));
  }
  const auto middle = [&](int a, int b) { return middles.at({std::min(a, b), std::max(a, b)}); };
  for (const auto& [a, b, c] : triangles) {
    const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    level.triangles.insert(level.triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return level;
}

}  // namespace

LoopSubdivision::LoopSubdivision(const std::vector<Triangle>& triangles, int num_vertices, int levels)
    : triangles_(triangles), num_coarse_(num_vertices) {
  std::vector<Row> rows(num_vertices);
  for (int v = 0; v < num_vertices; ++v) rows[v] = {{v, 1.0}};
  for (int k = 0; k < levels; ++k) {
    Level level = divide(triangles_, static_cast<int>(rows.size()));
    std::vector<Row> product;
    for (const Row& fine : level.rows) {
      Row row;
      for (const auto& [vertex, weight] : fine) {
        for (const auto& [coarse, share] : rows[vertex]) row[coarse] += weight * share;
      }
      product.push_back(std::move(row));
    }
    rows = std::move(product);
    triangles_ = std::move(level.triangles);
  }
  begins_ = {0};
  for (const Row& row : rows) {
    for (const auto& [vertex, weight] : row) entries_.push_back({vertex, static_cast<float>(weight)});
    begins_.push_back(static_cast<int>(entries_.size()));
  }
}

void LoopSubdivision::apply(std::span<const float> values, int width, std::span<float> result) const {
  for (std::size_t row = 0; row < result.size() / width; ++row) {
    for (int c = 0; c < width; ++c) {
      double sum = 0;
      for (int e = begins_[row]; e < begins_[row + 1]; ++e)
        sum += entries_[e].weight * values[static_cast<std::size_t>(width) * entries_[e].vertex + c];
      result[width * row + c] = static_cast<float>(sum);
    }
  }
}

std::vector<float> LoopSubdivision::apply(std::span<const float> values, int width) const {
  std::vector<float> fine(static_cast<std::size_t>(width) * num_vertices());
  apply(values, width, fine);
  return fine;
}

std::vector<float> LoopSubdivision::fit(std::span<const float> values, int width) const {
  constexpr int kRounds = 2;
  std::vector<float> control(values.begin(), values.end()), reached(values.size());
  for (int round = 0; round < kRounds; ++round) {
    apply(control, width, reached);  // the mesh's vertices are the first rows
    for (std::size_t k = 0; k < control.size(); ++k) control[k] += values[k] - reached[k];
  }
  return apply(control, width);
}

}  // namespace weft::engine
