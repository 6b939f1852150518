#include "weft/mesh/clean.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <set>

#include "weft/error.h"
#include "weft/mesh/sew.h"
#include "weft/mesh/slivers.h"

namespace weft::engine {
namespace {

/// Minimum thinness, area over longest edge squared, of a nondegenerate triangle [1].
constexpr double kMinThinness = 1e-10;

/// Distance within which borders of different pieces count as an open seam [m].
constexpr double kMaxOpenSeam = 0.005;

std::string number(long long n) { return std::to_string(n); }

/// For each vertex, the lowest-numbered one it merges with: within `distance`, directly or through a chain of
/// others. Sweeps in a direction with which real meshes are not aligned, so that few vertices tie.
std::vector<int> find_twins(const std::vector<Vec3>& positions, double distance) {
  const Vec3 direction = Vec3(0.6180, 0.5377, 0.5735).normalized();
  const int n = static_cast<int>(positions.size());
  std::vector<double> along(n);
  for (int v = 0; v < n; ++v) along[v] = positions[v].dot(direction);
  std::vector<int> order(n), twin(n);
  std::iota(order.begin(), order.end(), 0);
  std::iota(twin.begin(), twin.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return along[a] != along[b] ? along[a] < along[b] : a < b; });
  const auto root = [&](int v) {
    while (twin[v] != v) v = twin[v];
    return v;
  };
  for (int p = 0; p < n; ++p) {
    const int a = order[p];
    for (int q = p + 1; q < n && along[order[q]] - along[a] <= distance; ++q) {
      if ((positions[order[q]] - positions[a]).norm() > distance) continue;
      const int ra = root(a), rb = root(order[q]);
      twin[std::max(ra, rb)] = std::min(ra, rb);
    }
  }
  for (int v = 0; v < n; ++v) twin[v] = root(v);
  return twin;
}

int count_moved(const std::vector<int>& twin) {
  int count = 0;
  for (int v = 0; v < static_cast<int>(twin.size()); ++v) count += twin[v] != v;
  return count;
}

bool has_area(const TriangleMesh& mesh, int t) {
  const auto& [a, b, c] = mesh.triangles[t];
  if (a == b || b == c || c == a) return false;
  const auto& p = mesh.positions;
  const double longest_sq =
      std::max({(p[a] - p[b]).squaredNorm(), (p[b] - p[c]).squaredNorm(), (p[c] - p[a]).squaredNorm()});
  return triangle_area(mesh, t) > kMinThinness * longest_sq;
}

/// Keeps the triangles with keep(t); returns the number of dropped ones and the first of them.
template <class Keep>
std::pair<int, int> keep_triangles(CleanMesh& clean, const Keep& keep) {
  TriangleMesh& mesh = clean.mesh;
  std::vector<Triangle> kept;
  std::vector<int> source;
  int dropped = 0, first = -1;
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    if (keep(t)) {
      kept.push_back(mesh.triangles[t]);
      source.push_back(clean.source_triangle[t]);
    } else if (dropped++ == 0) {
      first = t;
    }
  }
  mesh.triangles = std::move(kept);
  clean.source_triangle = std::move(source);
  return {dropped, first};
}

Triangle sorted(Triangle triangle) {
  std::sort(triangle.begin(), triangle.end());
  return triangle;
}

/// How many of these triangles have the corners of an earlier one.
int count_repeated(const TriangleMesh& mesh, const std::vector<int>& triangles) {
  std::set<Triangle> different;
  for (const int t : triangles) different.insert(sorted(mesh.triangles[t]));
  return static_cast<int>(triangles.size() - different.size());
}

std::string counted(int count, const std::string& noun, const std::string& plural) {
  return number(count) + " " + (count == 1 ? noun : plural);
}

std::string counted(int count, const std::string& noun) { return counted(count, noun, noun + "s"); }

std::string in_digits(double value, const char* format) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

void sew(CleanMesh& clean, double distance) {
  SewnMesh sewn = sew_borders(clean.mesh, distance);
  static_cast<DerivedMesh&>(clean) = compose(clean, std::move(sewn));
  clean.notes.push_back("sewed " + counted(sewn.num_seams, "seam") + ": " + number(sewn.num_joined) +
                        " vertices, " + counted(sewn.num_divided, "edge") + " divided");
}

void remove_slivers(CleanMesh& clean, double short_edge) {
  const SliverLimits limits{.short_edge = short_edge};
  MeshWithoutSlivers without = remove_slivers(clean.mesh, limits);
  const int count = without.num_collapsed + without.num_divided;
  if (count == 0) return;
  clean.warnings.push_back(counted(count, "sliver") + " removed (lower than 2 % of the longest edge" +
                           (short_edge > 0 ? ", or with an edge below 15 % of the longest around and " +
                                                 in_digits(1000 * short_edge, "%.3g") + " mm): "
                                           : "): ") +
                           counted(without.num_collapsed, "short edge") + " collapsed, " +
                           counted(without.num_divided, "long edge") + " divided");
  static_cast<DerivedMesh&>(clean) = compose(clean, std::move(without));
}

/// Rounds a distance up to one significant digit [m].
double round_up(double distance) {
  double unit = 1e-4;
  while (distance > 10 * unit) unit *= 10;
  return std::max(1.0, std::ceil(distance / unit * (1 - 1e-9))) * unit;
}

void warn_about_open_seams(const TriangleMesh& mesh, std::vector<std::string>& warnings) {
  const OpenSeams open = find_open_seams(mesh, kMaxOpenSeam);
  if (open.num_seams == 0) return;
  warnings.push_back((open.num_seams == 1 ? std::string("2 borders are ")
                                          : number(open.num_seams) + " pairs of borders are up to ") +
                     in_digits(1000 * open.gap, "%.1f") +
                     " mm apart: sew = " + in_digits(round_up(open.gap), "%g") + " would join them");
}

void warn_about_topology(const TriangleMesh& mesh, std::vector<std::string>& warnings) {
  const int coincident = count_moved(find_twins(mesh.positions, 0));
  if (coincident > 0) {
    warnings.push_back(number(coincident) + " vertices coincide with another one: is this an unsewn seam? " +
                       "weld = true sews it");
  }
  int non_manifold = 0;
  std::string first;
  for (const Edge& edge : build_edges(mesh)) {
    if (edge.num_triangles <= 2) continue;
    if (non_manifold++ == 0) first = number(edge.a) + "–" + number(edge.b);
  }
  if (non_manifold > 0) {
    warnings.push_back(number(non_manifold) +
                       " edges belong to more than two triangles (non-manifold; the first is " + first +
                       "): they stretch as usual but have no bending spring");
  }
}

}  // namespace

CleanMesh clean_mesh(const TriangleMesh& source, const CleanOptions& options) {
  require_valid(source);
  CleanMesh result;
  result.mesh = source;
  TriangleMesh& mesh = result.mesh;
  auto& warnings = result.warnings;
  result.source_triangle.resize(source.triangles.size());
  std::iota(result.source_triangle.begin(), result.source_triangle.end(), 0);

  // Weld.
  std::vector<int> twin(source.positions.size());
  std::iota(twin.begin(), twin.end(), 0);
  if (options.weld_distance >= 0) {
    twin = find_twins(source.positions, options.weld_distance);
    for (Triangle& tri : mesh.triangles) {
      for (int& v : tri) v = twin[v];
    }
    if (const int welded = count_moved(twin); welded > 0)
      result.notes.push_back("welded " + counted(welded, "vertex", "vertices") + " to others");
  }

  // Drop degenerate triangles.
  const auto [flat, first_flat] = keep_triangles(result, [&](int t) { return has_area(mesh, t); });
  if (flat > 0) {
    warnings.push_back(number(flat) + " degenerate triangles were removed (the first is triangle " +
                       number(first_flat) + ")");
  }
  const bool welds_apart = options.weld_distance > 0;
  const int repeated_before = welds_apart ? count_repeated(source, result.source_triangle) : 0;
  std::set<Triangle> seen;
  const auto [repeated, first_repeated] =
      keep_triangles(result, [&](int t) { return seen.insert(sorted(mesh.triangles[t])).second; });
  if (repeated > 0) {
    const bool by_weld = welds_apart && repeated > repeated_before;
    warnings.push_back(number(repeated) + " duplicate triangles were removed" +
                       (by_weld ? ": weld joined layers that are nearer than " +
                                      in_digits(1000 * options.weld_distance, "%.3g") +
                                      " mm; sew joins borders only"
                                : ""));
  }
  if (mesh.triangles.empty()) throw InputError("all triangles of the mesh are degenerate");

  // Drop unused vertices, and compact the indices.
  std::vector<int> new_index(source.positions.size(), -1);
  for (const Triangle& tri : mesh.triangles) {
    for (const int v : tri) new_index[v] = 0;
  }
  std::vector<Vec3> kept;
  int isolated = 0;
  for (int v = 0; v < source.num_vertices(); ++v) {
    if (new_index[v] == 0) {
      new_index[v] = static_cast<int>(kept.size());
      kept.push_back(source.positions[v]);
    } else {
      isolated += twin[v] == v;
    }
  }
  if (isolated > 0) warnings.push_back(number(isolated) + " unused vertices were removed");
  mesh.positions = std::move(kept);
  for (Triangle& tri : mesh.triangles) {
    for (int& v : tri) v = new_index[v];
  }
  result.vertex_of_source.resize(source.positions.size());
  for (int v = 0; v < source.num_vertices(); ++v) result.vertex_of_source[v] = new_index[twin[v]];

  result.corner_weights.assign(mesh.triangles.size(), make_whole_weights());
  if (options.sew_distance > 0) sew(result, options.sew_distance);
  if (!options.is_cloth) return result;
  remove_slivers(result, options.short_edge);
  warn_about_topology(mesh, warnings);
  warn_about_open_seams(mesh, warnings);
  return result;
}

}  // namespace weft::engine
