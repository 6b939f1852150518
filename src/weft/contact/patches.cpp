#include "weft/contact/patches.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "weft/geometry/distance.h"

namespace weft::engine {
namespace {

constexpr int kCellsPerPatch = 2;  // of a grid, along each side

/// Rounding of float sums, for a gradient of about 1 [1].
constexpr float kRounding = 1e-4f;

Float4 normal_to(const Float4& a, const Float4& b) {
  const Eigen::Vector3f n = a.xyz().cross(b.xyz());
  const float length = n.norm();
  if (!(length > 0)) return Float4::Zero();
  return {n.x() / length, n.y() / length, n.z() / length, 0};
}

/// Shortest path lengths along the edges of some triangles.
class Ways {
 public:
  Ways(const Surface& surface, const std::vector<Vec3>& x, std::span<const int> triangles) {
    for (const int t : triangles)
      vertices_.insert(vertices_.end(), surface.triangles[t].begin(), surface.triangles[t].end());
    std::sort(vertices_.begin(), vertices_.end());
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
    for (const int t : triangles) {
      Triangle& own = corners_.emplace_back();
      for (int k = 0; k < 3; ++k) {
        const int v = surface.triangles[t][k];
        own[k] =
            static_cast<int>(std::lower_bound(vertices_.begin(), vertices_.end(), v) - vertices_.begin());
      }
      for (int k = 0; k < 3; ++k) {
        const int i = own[k], j = own[(k + 1) % 3];
        const double length = (x[vertices_[i]] - x[vertices_[j]]).norm();
        sides_.push_back({i, j, length});
        sides_.push_back({j, i, length});
      }
    }
    lengths_.resize(vertices_.size());
    std::sort(sides_.begin(), sides_.end());
    sides_.erase(std::unique(sides_.begin(), sides_.end()), sides_.end());
  }

  /// Numbers of the corners of the n-th triangle.
  const Triangle& corners(std::size_t n) const { return corners_[n]; }

  /// Lengths of the paths from a number to each number.
  const std::vector<double>& from(int number) {
    std::vector<double>& length = lengths_[number];
    if (!length.empty()) return length;
    length.assign(vertices_.size(), std::numeric_limits<double>::infinity());
    length[number] = 0;
    for (bool is_changing = true; is_changing;) {
      is_changing = false;
      for (const Side& side : sides_) {
        const double way = length[side.from] + side.length;
        if (way >= length[side.to]) continue;
        length[side.to] = way;
        is_changing = true;
      }
    }
    return length;
  }

 private:
  struct Side {
    int from, to;
    double length;
    auto operator<=>(const Side&) const = default;
  };

  std::vector<int> vertices_;  // ascending; a number is an index
  std::vector<Triangle> corners_;
  std::vector<Side> sides_;
  std::vector<std::vector<double>> lengths_;  // of from(), once it was called
};

/// Lower bound of the computed distance of two triangles: that of their boxes, less its rounding.
double box_distance(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b) {
  constexpr double kRoundingOfDistance = 1e-12;  // of the size of both
  return a.exteriorDistance(b) - kRoundingOfDistance * a.merged(b).diagonal().norm();
}

/// The least distance of two features, one of each triangle, that have no vertex in common.
double feature_distance(const std::vector<Vec3>& x, const Triangle& s, const Triangle& t) {
  double least_sq = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    if (!has_vertex(t, s[k]))
      least_sq = std::min(least_sq, point_triangle_distance(x[s[k]], x[t[0]], x[t[1]], x[t[2]]).distance_sq);
    if (!has_vertex(s, t[k]))
      least_sq = std::min(least_sq, point_triangle_distance(x[t[k]], x[s[0]], x[s[1]], x[s[2]]).distance_sq);
    for (int l = 0; l < 3; ++l) {
      const int i = s[k], j = s[(k + 1) % 3], m = t[l], n = t[(l + 1) % 3];
      if (i == m || i == n || j == m || j == n) continue;
      least_sq = std::min(least_sq, edge_edge_distance(x[i], x[j], x[m], x[n]).distance_sq);
    }
  }
  return std::sqrt(least_sq);
}

double longest_side(const std::vector<Vec3>& x, const Triangle& t) {
  return std::max({(x[t[1]] - x[t[0]]).norm(), (x[t[2]] - x[t[1]]).norm(), (x[t[0]] - x[t[2]]).norm()});
}

/// σ_min² of the matrix with the columns a, b.
float find_least_stretch_sq(const Float4& a, const Float4& b) {
  const float aa = a.squaredNorm(), bb = b.squaredNorm(), ab = a.dot(b);
  const float half = 0.5f * (aa - bb);
  return 0.5f * (aa + bb) - std::sqrt(half * half + ab * ab);
}

float difference_sq(const PatchDeformation& d, const PatchDeformation& e) {
  return (d.x - e.x).squaredNorm() + (d.y - e.y).squaredNorm() + (d.z - e.z).squaredNorm();
}

/// How far the surface of all triangles extends beyond the first `own` ones on every side, seen along
/// `normal`. No triangle faces away from `normal` [m].
double reach_around(const Surface& surface, const std::vector<Vec3>& rest, std::span<const int> region,
                    std::size_t own, const Vec3& normal) {
  const auto seen = [&](int v) -> Vec3 { return rest[v] - normal.dot(rest[v]) * normal; };
  std::vector<std::array<int, 2>> sides;
  for (const int t : region) {
    for (int k = 0; k < 3; ++k) {
      const auto [i, j] = std::minmax(surface.triangles[t][k], surface.triangles[t][(k + 1) % 3]);
      sides.push_back({i, j});
    }
  }
  std::sort(sides.begin(), sides.end());
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < sides.size(); ++s) {
    const bool is_shared =
        (s > 0 && sides[s] == sides[s - 1]) || (s + 1 < sides.size() && sides[s] == sides[s + 1]);
    if (is_shared) continue;
    for (const int t : region.first(own)) {
      const auto [i, j, k] = surface.triangles[t];
      least = std::min(
          least, segment_triangle_distance(seen(sides[s][0]), seen(sides[s][1]), seen(i), seen(j), seen(k))
                     .distance_sq);
    }
  }
  return std::sqrt(least);
}

}  // namespace

void Patches::add_patch(const Surface& surface, std::span<const int> triangles) {
  triangles_.insert(triangles_.end(), triangles.begin(), triangles.end());
  triangle_begin_.push_back(static_cast<int>(triangles_.size()));
  const auto first = static_cast<std::ptrdiff_t>(vertices_.size());
  for (const int t : triangles)
    vertices_.insert(vertices_.end(), surface.triangles[t].begin(), surface.triangles[t].end());
  std::sort(vertices_.begin() + first, vertices_.end());
  vertices_.erase(std::unique(vertices_.begin() + first, vertices_.end()), vertices_.end());
  vertex_begin_.push_back(static_cast<int>(vertices_.size()));
}

void Patches::add_grid(const Surface& surface, const Grid& grid, int first_vertex, int first_triangle) {
  const int first_patch = size(), first_window = num_windows();
  const double x = grid.spacing_x(), z = grid.spacing_z();
  std::vector<int> triangles;
  for (int j = 0; j < grid.cells_z; j += kCellsPerPatch) {
    for (int i = 0; i < grid.cells_x; i += kCellsPerPatch) {
      const int columns = std::min(kCellsPerPatch, grid.cells_x - i),
                rows = std::min(kCellsPerPatch, grid.cells_z - j);
      triangles.clear();
      for (int row = j; row < j + rows; ++row) {
        const int first = first_triangle + 2 * (row * grid.cells_x + i);
        for (int t = first; t < first + 2 * columns; ++t) triangles.push_back(t);
      }
      add_patch(surface, triangles);
      parts_.push_back({true, static_cast<int>(grid_parts_.size())});
      grid_parts_.push_back({first_vertex + grid.index(i, j), grid.num_columns(), columns, rows,
                             static_cast<float>(x), static_cast<float>(z)});
    }
  }
  num_cloth_ = size();
  const int columns = (grid.cells_x + kCellsPerPatch - 1) / kCellsPerPatch,
            rows = (grid.cells_z + kCellsPerPatch - 1) / kCellsPerPatch;
  const auto least = static_cast<float>(x * z / std::sqrt(x * x + z * z));
  const Window window{true, least, 1, least, 1};
  for (int j = 0; j < std::max(1, rows - 1); ++j) {
    for (int i = 0; i < std::max(1, columns - 1); ++i) {
      std::vector<int> members;
      for (int row = j; row < std::min(j + 2, rows); ++row) {
        for (int column = i; column < std::min(i + 2, columns); ++column)
          members.push_back(first_patch + row * columns + column);
      }
      add_window(members, window);
    }
  }
  list_neighbours(first_patch, first_window);
}

void Patches::add_mesh(const Surface& surface, const std::vector<Vec3>& rest, int first_triangle,
                       int end_triangle, JobSystem& jobs) {
  constexpr int kGrain = 16;  // windows per chunk of work
  const int first_patch = size(), first_window = num_windows();
  group(surface, first_triangle, end_triangle);
  num_cloth_ = size();
  for (int p = first_patch; p < size(); ++p) {
    parts_.push_back({false, static_cast<int>(mesh_parts_.size())});
    mesh_parts_.push_back(make_part(surface, rest, p));
  }
  const std::vector<std::vector<int>> rings = find_rings(first_patch);
  std::vector<Window> windows(rings.size());
  parallel_for(jobs, static_cast<int>(rings.size()), kGrain, [&](int begin, int end) {
    for (int r = begin; r < end; ++r) windows[r] = measure_rest(surface, rest, rings[r]);
  });
  for (std::size_t r = 0; r < rings.size(); ++r) add_window(rings[r], windows[r]);
  list_neighbours(first_patch, first_window);
}

void Patches::add_body(const Surface& surface, int first_triangle, int end_triangle) {
  group(surface, first_triangle, end_triangle);
}

/// Breadth-first grouping from the lowest triangle that is left.
void Patches::group(const Surface& surface, int first_triangle, int end_triangle) {
  std::vector<char> is_taken(end_triangle - first_triangle, 0);
  std::vector<int> patch;
  for (int seed = first_triangle; seed < end_triangle; ++seed) {
    if (is_taken[seed - first_triangle]) continue;
    patch.assign(1, seed);
    is_taken[seed - first_triangle] = 1;
    for (std::size_t n = 0; n < patch.size() && patch.size() < kMaxTriangles; ++n) {
      for (int corner = 0; corner < 3 && patch.size() < kMaxTriangles; ++corner) {
        const std::array<int, 2> side = {surface.triangles[patch[n]][corner],
                                         surface.triangles[patch[n]][(corner + 1) % 3]};
        surface.for_triangles_with(side, [&](int t) {
          if (is_taken[t - first_triangle] || patch.size() == kMaxTriangles) return;
          is_taken[t - first_triangle] = 1;
          patch.push_back(t);
        });
      }
    }
    add_patch(surface, patch);
  }
}

void Patches::add_window(std::span<const int> members, const Window& window) {
  members_.insert(members_.end(), members.begin(), members.end());
  member_begin_.push_back(static_cast<int>(members_.size()));
  windows_.push_back(window);
}

/// For each patch from `first_patch` on, the patch and its neighbours.
std::vector<std::vector<int>> Patches::find_rings(int first_patch) const {
  std::vector<std::pair<int, int>> uses;  // vertex, patch
  for (int p = first_patch; p < size(); ++p) {
    for (const int v : vertices(p)) uses.emplace_back(v, p);
  }
  std::sort(uses.begin(), uses.end());
  std::vector<std::vector<int>> rings;
  for (int p = first_patch; p < size(); ++p) {
    std::vector<int> around;
    for (const int v : vertices(p)) {
      for (auto use = std::lower_bound(uses.begin(), uses.end(), std::pair(v, 0));
           use != uses.end() && use->first == v; ++use) {
        if (use->second != p) around.push_back(use->second);
      }
    }
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    around.insert(around.begin(), p);
    rings.push_back(std::move(around));
  }
  return rings;
}

/// Neighbours of one cloth. A mesh window covers its first patch's pairs, a grid window all pairs.
void Patches::list_neighbours(int first_patch, int first_window) {
  struct Use {
    int a, b, window;
  };
  std::vector<Use> uses;
  for (int w = first_window; w < num_windows(); ++w) {
    const std::span<const int> all = members(w);
    for (std::size_t m = 0; m < all.size(); ++m) {
      for (std::size_t n = m; n < all.size() && (windows_[w].is_grid || m == 0); ++n)
        uses.push_back({std::min(all[m], all[n]), std::max(all[m], all[n]), w});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const Use& x, const Use& y) {
    return std::tie(x.a, x.b, x.window) < std::tie(y.a, y.b, y.window);
  });
  for (const Use& use : uses) {
    if (neighbours_.empty() || neighbours_.back().a != use.a || neighbours_.back().b != use.b)
      neighbours_.push_back({use.a, use.b, static_cast<int>(window_of_pair_.size()), 0});
    window_of_pair_.push_back(use.window);
    neighbours_.back().end_window = static_cast<int>(window_of_pair_.size());
  }
  int next = first_neighbour_.back();
  for (int p = first_patch; p < size(); ++p) {
    while (next < static_cast<int>(neighbours_.size()) && neighbours_[next].a == p) ++next;
    first_neighbour_.push_back(next);
  }
}

bool Patches::are_neighbours(int a, int b) const {
  if (b >= num_cloth_) return false;
  const auto first = neighbours_.begin() + first_neighbour_[a],
             last = neighbours_.begin() + first_neighbour_[a + 1];
  return std::any_of(first, last, [&](const Neighbours& n) { return n.b == b; });
}

/// Bounds for the first member's pairs. Near pairs are joined by the path above the straight line between
/// them, where the surface extends that far; others by a path between two corners plus the triangle sides.
Patches::Window Patches::measure_rest(const Surface& surface, const std::vector<Vec3>& rest,
                                      std::span<const int> members) const {
  constexpr double kMinFacing = 0.9;  // cosine limit for normals that point one way
  const auto is_sound = [&](int q) {
    const std::vector<TrianglePart>& parts = mesh_parts_[parts_[q].index].triangles;
    return std::all_of(parts.begin(), parts.end(), [](const TrianglePart& t) {
      return std::isfinite(t.inverse[0][0] + t.inverse[0][1] + t.inverse[1][0] + t.inverse[1][1]);
    });
  };
  if (!std::all_of(members.begin(), members.end(), is_sound)) return {};
  std::vector<int> region;
  for (const int q : members) region.insert(region.end(), triangles(q).begin(), triangles(q).end());
  const std::size_t own = triangles(members[0]).size();
  const Vec3 normal = mesh_parts_[parts_[members[0]].index].frame[2].xyz().cast<double>();
  double facing = 1;
  for (const int t : region) {
    const auto [i, j, k] = surface.triangles[t];
    facing = std::min(facing, normal.dot((rest[j] - rest[i]).cross(rest[k] - rest[i]).stableNormalized()));
  }
  const double around = facing > kMinFacing ? reach_around(surface, rest, region, own, normal) : 0;
  Ways ways(surface, rest, region);
  std::vector<Eigen::AlignedBox3d> boxes(region.size());
  for (std::size_t t = 0; t < region.size(); ++t) {
    for (const int v : surface.triangles[region[t]]) boxes[t].extend(rest[v]);
  }
  double least = std::numeric_limits<double>::infinity(), detour = 1;
  for (std::size_t s = 0; s < own; ++s) {
    const Triangle& a = surface.triangles[region[s]];
    std::array<const std::vector<double>*, 3> from{};
    for (int k = 0; k < 3; ++k) from[k] = &ways.from(ways.corners(s)[k]);
    const double side_a = longest_side(rest, a);
    for (std::size_t t = 0; t < region.size(); ++t) {
      const Triangle& b = surface.triangles[region[t]];
      if (t == s || num_shared_vertices(a, b) == 3) continue;
      const double side_b = longest_side(rest, b);
      double way = std::numeric_limits<double>::infinity();
      for (int k = 0; k < 3; ++k) {
        for (int l = 0; l < 3; ++l) way = std::min(way, (*from[k])[ways.corners(t)[l]]);
      }
      way += side_a + side_b;
      // For far triangles the corners suffice.
      double distance = (rest[a[0]] - rest[b[0]]).norm() - side_a - side_b;
      if (distance <= 2 * side_a) {
        const double bound = box_distance(boxes[s], boxes[t]);
        if (bound >= least && way / std::max(bound, around) <= detour) continue;  // neither would change
        distance = feature_distance(rest, a, b);
      }
      least = std::min(least, distance);
      detour = std::max(detour, way / std::max(distance, around));
    }
  }
  if (!std::isfinite(least) || !std::isfinite(detour)) return {};
  const auto near = static_cast<float>(least), far = static_cast<float>(std::max(least, around)),
             way = static_cast<float>(detour);
  const float straight = around > 0 ? static_cast<float>(1 / facing) : way;
  return {false, near, straight, far, way};
}

Patches::MeshPart Patches::make_part(const Surface& surface, const std::vector<Vec3>& rest, int patch) const {
  MeshPart part;
  Vec3 middle = Vec3::Zero(), normal = Vec3::Zero();
  for (const int v : vertices(patch)) middle += rest[v] / static_cast<double>(vertices(patch).size());
  for (const int t : triangles(patch)) {
    const auto [i, j, k] = surface.triangles[t];
    normal += (rest[j] - rest[i]).cross(rest[k] - rest[i]);
  }
  normal = normal.stableNormalized();
  const Vec3 first = normal.unitOrthogonal(), second = normal.cross(first);
  const Vec3 frame[3] = {first, second, normal};
  for (int k = 0; k < 3; ++k) part.frame[k] = to_float4(frame[k]);

  Eigen::Matrix2d moments = Eigen::Matrix2d::Zero();
  const auto plane = [&](const Vec3& p) { return Eigen::Vector2d(first.dot(p), second.dot(p)); };
  for (const int v : vertices(patch)) {
    const Eigen::Vector2d at = plane(rest[v] - middle);
    moments += at * at.transpose();
  }
  const Eigen::Matrix2d inverse = moments.inverse();
  for (const int v : vertices(patch)) {
    const Eigen::Vector2d weight = inverse * plane(rest[v] - middle);
    part.weights.push_back({static_cast<float>(weight.x()), static_cast<float>(weight.y())});
  }
  for (const int t : triangles(patch)) {
    const auto [i, j, k] = surface.triangles[t];
    const Vec3 e1 = rest[j] - rest[i], e2 = rest[k] - rest[i];
    const Vec3 u = e1.stableNormalized(), v = e1.cross(e2).cross(e1).stableNormalized();
    Eigen::Matrix2d edges;
    edges << u.dot(e1), u.dot(e2), 0, v.dot(e2);
    const Eigen::Matrix2f own = edges.inverse().cast<float>();
    TrianglePart triangle{i, j, k, {{own(0, 0), own(0, 1)}, {own(1, 0), own(1, 1)}}, {}};
    for (int c = 0; c < 3; ++c) {
      triangle.tangents[0][c] = static_cast<float>(frame[c].dot(u));
      triangle.tangents[1][c] = static_cast<float>(frame[c].dot(v));
    }
    part.triangles.push_back(triangle);
  }
  return part;
}

PatchDeformation Patches::measure(int patch, const std::vector<Float4>& x) const {
  const Part& part = parts_[patch];
  return part.is_grid ? measure(grid_parts_[part.index], x)
                      : measure(mesh_parts_[part.index], vertices(patch), x);
}

/// In a grid triangle the columns of F are two sides of its cell.
PatchDeformation Patches::measure(const GridPart& g, const std::vector<Float4>& x) const {
  const auto at = [&](int row, int column) -> const Float4& { return x[g.first + row * g.stride + column]; };
  Float4 along_x = Float4::Zero(), along_z = Float4::Zero();
  for (int row = 0; row <= g.rows; ++row) along_x += at(row, g.columns) - at(row, 0);
  for (int column = 0; column <= g.columns; ++column) along_z += at(g.rows, column) - at(0, column);
  along_x /= static_cast<float>((g.rows + 1) * g.columns);
  along_z /= static_cast<float>((g.columns + 1) * g.rows);
  float most_x = 0, most_z = 0;
  for (int row = 0; row <= g.rows; ++row) {
    for (int column = 0; column < g.columns; ++column)
      most_x = std::max(most_x, (at(row, column + 1) - at(row, column) - along_x).squaredNorm());
  }
  for (int row = 0; row < g.rows; ++row) {
    for (int column = 0; column <= g.columns; ++column)
      most_z = std::max(most_z, (at(row + 1, column) - at(row, column) - along_z).squaredNorm());
  }
  const Float4 a = along_x / g.cell_x, b = along_z / g.cell_z;
  // At rest no vector points along y, so M's second column has no effect.
  return {a, Float4::Zero(), b, find_least_stretch_sq(a, b),
          std::sqrt(most_x / (g.cell_x * g.cell_x) + most_z / (g.cell_z * g.cell_z))};
}

PatchDeformation Patches::measure(const MeshPart& part, std::span<const int> vertices,
                                  const std::vector<Float4>& x) const {
  Float4 a = Float4::Zero(), b = Float4::Zero();
  for (std::size_t n = 0; n < vertices.size(); ++n) {
    const Float4 from_first = x[vertices[n]] - x[vertices[0]];
    a += part.weights[n][0] * from_first;
    b += part.weights[n][1] * from_first;
  }
  const Float4 n = normal_to(a, b);
  float most = 0;
  for (const TrianglePart& t : part.triangles) {
    const Float4 e1 = x[t.j] - x[t.i], e2 = x[t.k] - x[t.i];
    float sum = 0;
    for (int c = 0; c < 2; ++c) {
      const Float4 column = t.inverse[0][c] * e1 + t.inverse[1][c] * e2;
      const Float4 mean = t.tangents[c][0] * a + t.tangents[c][1] * b + t.tangents[c][2] * n;
      sum += (column - mean).squaredNorm();
    }
    most = std::max(most, sum);
  }
  const auto image_of = [&](int axis) -> Float4 {
    return part.frame[0][axis] * a + part.frame[1][axis] * b + part.frame[2][axis] * n;
  };
  return {image_of(0), image_of(1), image_of(2), std::min(1.0f, find_least_stretch_sq(a, b)),
          std::sqrt(most)};
}

/// M of a window.
PatchDeformation Patches::reference(int window, const std::vector<PatchDeformation>& at) const {
  const std::span<const int> all = members(window);
  if (!windows_[window].is_grid) return at[all[0]];
  const float share = 1 / static_cast<float>(all.size());
  PatchDeformation mean{Float4::Zero(), Float4::Zero(), Float4::Zero()};
  for (const int p : all) {
    mean.x += share * at[p].x;
    mean.z += share * at[p].z;
  }
  mean.least_stretch_sq = find_least_stretch_sq(mean.x, mean.z);
  return mean;
}

float Patches::least_distance(int w, const std::vector<PatchDeformation>& start,
                              const std::vector<PatchDeformation>& end) const {
  const Window& window = windows_[w];
  if (window.least_distance == 0) return 0;
  const PatchDeformation first = reference(w, start), last = reference(w, end);
  float deviation = 0;
  for (const int p : members(w)) {
    deviation = std::max({deviation, std::sqrt(difference_sq(start[p], first)) + start[p].deviation,
                          std::sqrt(difference_sq(end[p], last)) + end[p].deviation});
  }
  const float stretch_sq =
      std::min(first.least_stretch_sq, last.least_stretch_sq) - 0.25f * difference_sq(first, last);
  if (!(stretch_sq > 0)) return 0;
  const auto bound = [&](float distance, float detour) {
    return std::max(0.0f, std::sqrt(stretch_sq) - detour * (deviation + kRounding)) * distance;
  };
  return std::min(bound(window.least_distance, window.detour), bound(window.far, window.detour_of_far));
}

}  // namespace weft::engine
