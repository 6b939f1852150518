#include "weft/forces/element_tables.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "weft/forces/element_kernels.h"

namespace weft::engine {
namespace {

using kernels::MeshElements;

constexpr int kLanes = kPackLanes;

/// A patch with its common edge first, as in MeshElements.
struct OrderedPatch {
  std::array<int, 4> vertices = {};
  std::array<Vec2, 4> gradients = {};  // of vertices 1, 2 in the first triangle, 1, 3 in the second
  std::array<double, 2> areas = {};
};

OrderedPatch order(const MembranePatch& patch) {
  int start = 0;  // corner of the first triangle at which the common edge begins
  if (patch.num_triangles == 2) {
    const auto& second = patch.corners[1];
    while (std::find(second.begin(), second.end(), (start + 2) % 3) != second.end()) ++start;
  }
  const std::array<int, 3> first = {start, (start + 1) % 3, (start + 2) % 3};
  OrderedPatch ordered;
  for (int c = 0; c < 3; ++c) ordered.vertices[c] = patch.vertices[first[c]];
  ordered.vertices[3] = patch.vertices[patch.num_triangles == 2 ? 3 : first[0]];
  ordered.gradients = {patch.rest[0].gradient[first[1]], patch.rest[0].gradient[first[2]], Vec2::Zero(),
                       Vec2::Zero()};
  ordered.areas = {patch.rest[0].area, patch.rest[1].area};
  for (int c = 0; c < 3 && patch.num_triangles == 2; ++c) {
    if (patch.corners[1][c] == first[1]) ordered.gradients[2] = patch.rest[1].gradient[c];
    if (patch.corners[1][c] == 3) ordered.gradients[3] = patch.rest[1].gradient[c];
  }
  return ordered;
}

/// An edge from one of its ends, with one or two couplings of patches.
struct Entry {
  int neighbour = 0;
  int coupling[2] = {-1, -1};  // as in MeshElements; -1: none
  int num_couplings = 0;
  double bending = 0;
};

struct FarEntry {
  int neighbour = 0;
  double bending = 0;
};

void add_coupling(std::vector<Entry>& entries, int neighbour, int coupling) {
  auto entry = std::find_if(entries.begin(), entries.end(),
                            [&](const Entry& e) { return e.neighbour == neighbour && e.num_couplings < 2; });
  if (entry == entries.end()) entry = entries.insert(entries.end(), Entry{.neighbour = neighbour});
  entry->coupling[entry->num_couplings++] = coupling;
}

std::vector<std::vector<Entry>> find_entries(const std::vector<OrderedPatch>& patches, int num_particles) {
  std::vector<std::vector<Entry>> around(num_particles);
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const int slice = static_cast<int>(p) / kLanes, lane = static_cast<int>(p) % kLanes;
    const bool is_pair = patches[p].areas[1] > 0;
    int place = slice * MeshElements::kPatchSize * kLanes + lane;
    for (int a = 0; a < 3; ++a) {
      for (int b = a + 1; b < 4; ++b, place += MeshElements::kCouplingSize * kLanes) {
        if (b == 3 && !is_pair) continue;
        const int i = patches[p].vertices[a], j = patches[p].vertices[b];
        add_coupling(around[i], j, 2 * place);
        add_coupling(around[j], i, 2 * place + 1);
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

void lay_out_patches(const std::vector<OrderedPatch>& patches, ElementTables& tables) {
  // At least one more than there are: its couplings are zero.
  const auto count = static_cast<std::size_t>(round_up_to_pack(static_cast<int>(patches.size()) + 1));
  tables.corner.assign(4 * count, 0);
  tables.shape.assign(MeshElements::kShapeSize * count, 0.0f);
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const auto& [vertices, gradients, areas] = patches[p];
    const std::size_t slice = p / kLanes, lane = p % kLanes;
    for (int c = 0; c < 4; ++c) tables.corner[(slice * 4 + c) * kLanes + lane] = vertices[c];
    const auto& [g1, g2, h1, h3] = gradients;
    const double shape[] = {g1.x(),
                            g1.y(),
                            g2.x(),
                            g2.y(),
                            h1.x(),
                            h1.y(),
                            h3.x(),
                            h3.y(),
                            areas[0],
                            areas[1],
                            1 / (areas[0] + areas[1])};
    for (int k = 0; k < MeshElements::kShapeSize; ++k)
      tables.shape[(slice * MeshElements::kShapeSize + k) * kLanes + lane] = static_cast<float>(shape[k]);
  }
}

/// `none`: a coupling that is zero.
void lay_out_entries(const std::vector<std::vector<Entry>>& around, int none, ElementTables& tables) {
  tables.slice_begin = slice_rows(around);
  const std::size_t rows = tables.slice_begin.back();
  tables.neighbour.assign(rows * kLanes, 0);
  tables.coupling.assign(rows * 2 * kLanes, none);
  tables.bending.assign(rows * kLanes, 0.0f);
  for (std::size_t i = 0; i < around.size(); ++i) {
    const std::size_t lane = i % kLanes;
    std::size_t row = tables.slice_begin[i / kLanes];
    for (const Entry& e : around[i]) {
      tables.neighbour[row * kLanes + lane] = e.neighbour;
      for (int k = 0; k < e.num_couplings; ++k)
        tables.coupling[(row * 2 + k) * kLanes + lane] = e.coupling[k];
      tables.bending[row * kLanes + lane] = static_cast<float>(e.bending);
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
  std::vector<OrderedPatch> patches;
  tables.place_of_triangle.resize(elements.membranes.size());
  for (const MembranePatch& patch : elements.patches) {
    for (int t = 0; t < patch.num_triangles; ++t)
      tables.place_of_triangle[patch.triangles[t]] = 2 * static_cast<int>(patches.size()) + t;
    patches.push_back(order(patch));
  }
  std::vector<std::vector<Entry>> around = find_entries(patches, num_particles);
  const std::vector<std::vector<FarEntry>> far = add_bending(elements.bending, around);
  lay_out_patches(patches, tables);
  const int padding = tables.num_patch_slices() * kLanes - 1;
  lay_out_entries(around, 2 * (padding / kLanes * MeshElements::kPatchSize * kLanes + padding % kLanes),
                  tables);
  lay_out_far(far, tables);
  return tables;
}

}  // namespace weft::engine
