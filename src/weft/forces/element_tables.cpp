#include "weft/forces/element_tables.h"

#include <algorithm>
#include <cmath>

#include "weft/forces/element_kernels.h"

namespace weft::engine {
namespace {

using kernels::MeshElements;

constexpr int kLanes = kPackLanes;

/// An edge from one of its ends, with one or two of its triangles.
struct Entry {
  int neighbour = 0;
  int triangle[2] = {0, 0};
  int num_triangles = 0;
  double gradients[2][4] = {};  // √area times (own 1, own 2, neighbour's 1, neighbour's 2)
  double bending = 0;
};

struct FarEntry {
  int neighbour = 0;
  double bending = 0;
};

void add_triangle(std::vector<Entry>& entries, int neighbour, int triangle, double root, const Vec2& own,
                  const Vec2& other) {
  auto entry = std::find_if(entries.begin(), entries.end(),
                            [&](const Entry& e) { return e.neighbour == neighbour && e.num_triangles < 2; });
  if (entry == entries.end()) entry = entries.insert(entries.end(), Entry{.neighbour = neighbour});
  const int k = entry->num_triangles++;
  entry->triangle[k] = triangle;
  const double gradients[4] = {root * own.x(), root * own.y(), root * other.x(), root * other.y()};
  std::copy(gradients, gradients + 4, entry->gradients[k]);
}

std::vector<std::vector<Entry>> find_entries(const ClothElements& elements, int num_particles) {
  std::vector<std::vector<Entry>> around(num_particles);
  for (std::size_t t = 0; t < elements.membranes.size(); ++t) {
    const auto& [vertices, rest] = elements.membranes[t];
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        if (a == b) continue;
        add_triangle(around[vertices[a]], vertices[b], static_cast<int>(t), std::sqrt(rest.area),
                     rest.gradient[a], rest.gradient[b]);
      }
    }
  }
  return around;
}

/// Adds bending to the first entry of its edge; couplings without an edge go to a separate list.
std::vector<std::vector<FarEntry>> add_bending(const BendingRows& rows,
                                               std::vector<std::vector<Entry>>& around) {
  const int n = static_cast<int>(around.size());
  const BendingMatrix matrix = build_bending_matrix(rows, n);
  std::vector<std::vector<FarEntry>> far(n);
  for (int i = 0; i < n; ++i) {
    for (int k = matrix.begin[i]; k < matrix.begin[i + 1]; ++k) {
      const int j = matrix.column[k];
      if (j == i) continue;
      const auto entry =
          std::find_if(around[i].begin(), around[i].end(), [&](const Entry& e) { return e.neighbour == j; });
      if (entry != around[i].end()) {
        entry->bending = -matrix.value[k];
      } else {
        far[i].push_back({j, -matrix.value[k]});
      }
    }
  }
  return far;
}

/// First row of each slice, and the end of the last one: a slice has as many rows as its longest list.
template <class Item>
std::vector<int> slice_rows(const std::vector<std::vector<Item>>& lists) {
  std::vector<int> begin = {0};
  for (std::size_t first = 0; first < lists.size(); first += kLanes) {
    std::size_t most = 0;
    for (std::size_t i = first; i < std::min(first + kLanes, lists.size()); ++i)
      most = std::max(most, lists[i].size());
    begin.push_back(begin.back() + static_cast<int>(most));
  }
  return begin;
}

void lay_out_triangles(const ClothElements& elements, ElementTables& tables) {
  const int count = round_up_to_pack(static_cast<int>(elements.membranes.size()));
  tables.corner.assign(3 * static_cast<std::size_t>(count), 0);
  tables.shape.assign(MeshElements::kShapeSize * static_cast<std::size_t>(count), 0.0f);
  for (std::size_t t = 0; t < elements.membranes.size(); ++t) {
    const auto& [vertices, rest] = elements.membranes[t];
    const std::size_t slice = t / kLanes, lane = t % kLanes;
    for (int c = 0; c < 3; ++c) tables.corner[(slice * 3 + c) * kLanes + lane] = vertices[c];
    const double shape[] = {rest.gradient[1].x(), rest.gradient[1].y(), rest.gradient[2].x(),
                            rest.gradient[2].y(), rest.area};
    for (int k = 0; k < MeshElements::kShapeSize; ++k)
      tables.shape[(slice * MeshElements::kShapeSize + k) * kLanes + lane] = static_cast<float>(shape[k]);
  }
}

void lay_out_entries(const std::vector<std::vector<Entry>>& around, ElementTables& tables) {
  tables.slice_begin = slice_rows(around);
  const std::size_t rows = tables.slice_begin.back();
  tables.neighbour.assign(rows * kLanes, 0);
  tables.triangle.assign(rows * 2 * kLanes, 0);
  tables.entry.assign(rows * MeshElements::kEntrySize * kLanes, 0.0f);
  for (std::size_t i = 0; i < around.size(); ++i) {
    const std::size_t lane = i % kLanes;
    std::size_t row = tables.slice_begin[i / kLanes];
    for (const Entry& e : around[i]) {
      tables.neighbour[row * kLanes + lane] = e.neighbour;
      float* numbers = &tables.entry[row * MeshElements::kEntrySize * kLanes + lane];
      for (int t = 0; t < 2; ++t) {
        tables.triangle[(row * 2 + t) * kLanes + lane] = e.triangle[t];
        for (int k = 0; k < 4; ++k) numbers[(4 * t + k) * kLanes] = static_cast<float>(e.gradients[t][k]);
      }
      numbers[8 * kLanes] = static_cast<float>(e.bending);
      ++row;
    }
  }
}

void lay_out_far(const std::vector<std::vector<FarEntry>>& far, ElementTables& tables) {
  tables.far_begin = slice_rows(far);
  const std::size_t rows = tables.far_begin.back();
  tables.far_neighbour.assign(rows * kLanes, 0);
  tables.far_bending.assign(rows * kLanes, 0.0f);
  for (std::size_t i = 0; i < far.size(); ++i) {
    std::size_t at = tables.far_begin[i / kLanes] * kLanes + i % kLanes;
    for (const FarEntry& e : far[i]) {
      tables.far_neighbour[at] = e.neighbour;
      tables.far_bending[at] = static_cast<float>(e.bending);
      at += kLanes;
    }
  }
}

}  // namespace

ElementTables build_element_tables(const ClothElements& elements, int num_particles) {
  ElementTables tables;
  std::vector<std::vector<Entry>> around = find_entries(elements, num_particles);
  const std::vector<std::vector<FarEntry>> far = add_bending(elements.bending, around);
  lay_out_triangles(elements, tables);
  lay_out_entries(around, tables);
  lay_out_far(far, tables);
  return tables;
}

}  // namespace weft::engine
