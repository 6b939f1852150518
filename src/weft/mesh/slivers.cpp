#include "weft/mesh/slivers.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

namespace weft::engine {
namespace {

constexpr int kMaxPasses = 20;
constexpr double kNeedle = 2.5;     // times flatness: shorter edges are collapsed [1]
constexpr double kShort = 0.15;     // maximum length of a short edge, as a share of the longest around [1]
constexpr double kMinCosine = 0.2;  // minimum between a triangle's normals before and after [1]

/// A flat triangle with longest edge a–b.
struct Sliver {
  int triangle = 0, a = 0, b = 0, apex = 0;
  double along = 0;  // position of the apex on the longest edge, 0 at a [1]
  int twin = -1;     // a or b if the apex is next to it, else -1
};

std::optional<Sliver> look_at(const TriangleMesh& mesh, int t, double flatness) {
  const Triangle& v = mesh.triangles[t];
  Sliver sliver{.triangle = t};
  double longest = 0;
  for (int k = 0; k < 3; ++k) {
    const int a = v[k], b = v[(k + 1) % 3];
    const double length = (mesh.positions[b] - mesh.positions[a]).norm();
    if (length <= longest) continue;
    longest = length;
    sliver = {.triangle = t, .a = a, .b = b, .apex = v[(k + 2) % 3]};
  }
  if (2 * triangle_area(mesh, t) >= flatness * longest * longest) return {};
  const Vec3 base = mesh.positions[sliver.b] - mesh.positions[sliver.a];
  sliver.along = (mesh.positions[sliver.apex] - mesh.positions[sliver.a]).dot(base) / (longest * longest);
  for (const int end : {sliver.a, sliver.b}) {
    if ((mesh.positions[sliver.apex] - mesh.positions[end]).norm() < kNeedle * flatness * longest)
      sliver.twin = end;
  }
  return sliver;
}

Vec3 normal_of(const TriangleMesh& mesh, const Triangle& t) {
  const Vec3& o = mesh.positions[t[0]];
  return (mesh.positions[t[1]] - o).cross(mesh.positions[t[2]] - o);
}

/// Barycentric coordinates of a point's foot in a triangle's plane.
Vec3 coordinates_in(const TriangleMesh& mesh, int t, const Vec3& p) {
  const auto& [i, j, k] = mesh.triangles[t];
  const Vec3 &a = mesh.positions[i], &b = mesh.positions[j], &c = mesh.positions[k];
  const Vec3 normal = (b - a).cross(c - a);
  const double v = normal.dot((c - p).cross(a - p)) / normal.squaredNorm(),
               w = normal.dot((a - p).cross(b - p)) / normal.squaredNorm();
  return {1 - v - w, v, w};
}

bool has(const Triangle& t, int v) { return std::ranges::find(t, v) != t.end(); }

Triangle with(Triangle t, int old_vertex, int new_vertex) {
  std::ranges::replace(t, old_vertex, new_vertex);
  return t;
}

/// One pass: removes slivers that share no neighbours, one by one.
class Pass {
 public:
  Pass(const TriangleMesh& mesh, const SliverLimits& limits)
      : mesh_(mesh),
        limits_(limits),
        around_(mesh.positions.size()),
        is_touched_(mesh.positions.size(), 0),
        is_dropped_(mesh.triangles.size(), 0),
        stands_for_(mesh.positions.size()) {
    std::iota(stands_for_.begin(), stands_for_.end(), 0);
    for (int t = 0; t < mesh.num_triangles(); ++t) {
      for (const int v : mesh.triangles[t]) around_[v].push_back(t);
    }
  }

  void run() {
    for (int t = 0; t < mesh_.num_triangles(); ++t) {
      if (collapse_short_edge(t)) {
        ++num_collapsed_;
        continue;
      }
      const std::optional<Sliver> sliver = look_at(mesh_, t, limits_.flatness);
      if (!sliver || is_touched(*sliver)) continue;
      if (sliver->twin >= 0) {
        num_collapsed_ += collapse(sliver->apex, sliver->twin);
      } else {
        num_divided_ += divide(*sliver);
      }
    }
  }

  int num_collapsed() const { return num_collapsed_; }
  int num_divided() const { return num_divided_; }
  DerivedMesh result() const;

 private:
  struct Part {
    Triangle vertices;
    int source;
    CornerWeights weights;
  };

  bool is_touched(const Sliver& s) const {
    return is_touched_[s.a] || is_touched_[s.b] || is_touched_[s.apex];
  }

  /// Marks a vertex and all its neighbours.
  void touch(int vertex) {
    for (const int t : around_[vertex]) {
      for (const int v : mesh_.triangles[t]) is_touched_[v] = 1;
    }
  }

  std::vector<int> triangles_at(int a, int b) const {
    std::vector<int> both;
    for (const int t : around_[a]) {
      if (has(mesh_.triangles[t], b)) both.push_back(t);
    }
    return both;
  }

  std::vector<int> neighbours_of(int vertex) const {
    std::vector<int> all;
    for (const int t : around_[vertex]) {
      for (const int v : mesh_.triangles[t]) {
        if (v != vertex) all.push_back(v);
      }
    }
    std::ranges::sort(all);
    all.erase(std::ranges::unique(all).begin(), all.end());
    return all;
  }

  bool is_on_border(int vertex) const {
    return std::ranges::any_of(neighbours_of(vertex),
                               [&](int v) { return triangles_at(vertex, v).size() == 1; });
  }

  bool turns_over(const Triangle& from, const Triangle& to) const {
    const Vec3 before = normal_of(mesh_, from), after = normal_of(mesh_, to);
    return before.dot(after) <= kMinCosine * before.norm() * after.norm();
  }

  double length(int a, int b) const { return (mesh_.positions[b] - mesh_.positions[a]).norm(); }

  /// Longest edge of the triangles at a vertex.
  double longest_edge_at(int vertex) const {
    double longest = 0;
    for (const int t : around_[vertex]) {
      const auto& [a, b, c] = mesh_.triangles[t];
      longest = std::max({longest, length(a, b), length(b, c), length(c, a)});
    }
    return longest;
  }

  bool is_short(int a, int b) const {
    const double edge = length(a, b);
    return edge < limits_.short_edge && edge < kShort * std::max(longest_edge_at(a), longest_edge_at(b));
  }

  bool collapse_short_edge(int triangle);
  bool is_sliver(int triangle) const {
    const auto& [a, b, c] = mesh_.triangles[triangle];
    return is_short(a, b) || is_short(b, c) || is_short(c, a) || look_at(mesh_, triangle, limits_.flatness);
  }

  bool collapse(int a, int b);
  bool drop_ear(int tip, int twin);
  bool divide(const Sliver& s);

  const TriangleMesh& mesh_;
  SliverLimits limits_;
  std::vector<std::vector<int>> around_;  // triangles by vertex
  std::vector<char> is_touched_, is_dropped_;
  std::vector<int> stands_for_;  // (vertices) itself, or its vertex after collapses
  std::vector<Part> parts_;
  int num_collapsed_ = 0, num_divided_ = 0;
};

/// Collapses the shortest possible edge.
bool Pass::collapse_short_edge(int triangle) {
  const auto& [a, b, c] = mesh_.triangles[triangle];
  if (is_touched_[a] || is_touched_[b] || is_touched_[c]) return false;
  std::array<std::array<int, 2>, 3> edges = {{{a, b}, {b, c}, {c, a}}};
  std::ranges::stable_sort(edges, {}, [&](const auto& e) { return length(e[0], e[1]); });
  return std::ranges::any_of(edges,
                             [&](const auto& e) { return is_short(e[0], e[1]) && collapse(e[0], e[1]); });
}

/// Drops a tip with only one triangle. Not if its neighbour is a sliver too: that would consume a ribbon.
bool Pass::drop_ear(int tip, int twin) {
  const int ear = around_[tip][0];
  const auto& [a, b, c] = mesh_.triangles[ear];
  const int p = tip == a ? b : a, q = tip == c ? b : c;
  for (const int t : triangles_at(p, q)) {
    if (t == ear || is_sliver(t)) continue;
    touch(tip);
    stands_for_[tip] = twin;
    is_dropped_[ear] = 1;
    return true;
  }
  return false;
}

/// Link condition: the common neighbours of both ends must be the corners opposite to the edge.
bool Pass::collapse(int a, int b) {
  if (around_[a].size() == 1) return drop_ear(a, b);
  if (around_[b].size() == 1) return drop_ear(b, a);
  const std::vector<int> at_edge = triangles_at(a, b);
  const bool border_a = is_on_border(a), border_b = is_on_border(b);
  if (at_edge.size() > 2 || (border_a && border_b && at_edge.size() == 2)) return false;
  const std::vector<int> at_a = neighbours_of(a), at_b = neighbours_of(b);
  std::vector<int> common;
  std::ranges::set_intersection(at_a, at_b, std::back_inserter(common));
  if (common.size() != at_edge.size()) return false;
  const int kept = border_a != border_b ? (border_a ? a : b) : std::min(a, b), gone = a + b - kept;
  for (const int t : around_[gone]) {
    const Triangle& from = mesh_.triangles[t];
    if (!has(from, kept) && turns_over(from, with(from, gone, kept))) return false;
  }
  touch(a);
  touch(b);
  stands_for_[gone] = kept;
  for (const int t : at_edge) is_dropped_[t] = 1;
  return true;
}

/// Drops the sliver, and divides the other triangles of its longest edge at the apex.
bool Pass::divide(const Sliver& s) {
  std::vector<Part> parts;
  for (const int t : triangles_at(s.a, s.b)) {
    if (t == s.triangle) continue;
    const Triangle& whole = mesh_.triangles[t];
    const int opposite = *std::ranges::find_if(whole, [&](int v) { return v != s.a && v != s.b; });
    if (opposite == s.apex || !triangles_at(s.apex, opposite).empty()) return false;
    const CornerWeights corners = make_whole_weights();
    const Vec3 at_apex = (1 - s.along) * corners[std::ranges::find(whole, s.a) - whole.begin()] +
                         s.along * corners[std::ranges::find(whole, s.b) - whole.begin()];
    for (const int replaced : {s.b, s.a}) {
      Part part{with(whole, replaced, s.apex), t, corners};
      part.weights[std::ranges::find(whole, replaced) - whole.begin()] = at_apex;
      if (turns_over(whole, part.vertices)) return false;
      parts.push_back(part);
    }
  }
  for (const int v : {s.a, s.b, s.apex}) touch(v);
  is_dropped_[s.triangle] = 1;
  for (const Part& part : parts) is_dropped_[part.source] = 1;
  parts_.insert(parts_.end(), parts.begin(), parts.end());
  return true;
}

DerivedMesh Pass::result() const {
  std::vector<Part> all;
  for (int t = 0; t < mesh_.num_triangles(); ++t) {
    if (!is_dropped_[t]) all.push_back({mesh_.triangles[t], t, make_whole_weights()});
  }
  all.insert(all.end(), parts_.begin(), parts_.end());
  std::vector<int> index(mesh_.positions.size(), -1);
  for (Part& part : all) {
    for (int c = 0; c < 3; ++c) {
      int& v = part.vertices[c];
      if (stands_for_[v] != v)
        part.weights[c] = coordinates_in(mesh_, part.source, mesh_.positions[stands_for_[v]]);
      index[v = stands_for_[v]] = 0;
    }
  }
  DerivedMesh result;
  for (std::size_t v = 0; v < index.size(); ++v) {
    if (index[v] < 0) continue;
    index[v] = result.mesh.num_vertices();
    result.mesh.positions.push_back(mesh_.positions[v]);
  }
  for (const Part& part : all) {
    const auto& [a, b, c] = part.vertices;
    result.mesh.triangles.push_back({index[a], index[b], index[c]});
    result.source_triangle.push_back(part.source);
    result.corner_weights.push_back(part.weights);
  }
  for (const int v : stands_for_) result.vertex_of_source.push_back(index[v]);
  return result;
}

DerivedMesh make_derived(const TriangleMesh& mesh) {
  DerivedMesh same{.mesh = mesh};
  same.vertex_of_source.resize(mesh.positions.size());
  std::iota(same.vertex_of_source.begin(), same.vertex_of_source.end(), 0);
  same.source_triangle.resize(mesh.triangles.size());
  std::iota(same.source_triangle.begin(), same.source_triangle.end(), 0);
  same.corner_weights.assign(mesh.triangles.size(), make_whole_weights());
  return same;
}

}  // namespace

MeshWithoutSlivers remove_slivers(const TriangleMesh& mesh, const SliverLimits& limits) {
  MeshWithoutSlivers result{make_derived(mesh)};
  for (int pass_number = 0; pass_number < kMaxPasses; ++pass_number) {
    Pass pass(result.mesh, limits);
    pass.run();
    if (pass.num_collapsed() + pass.num_divided() == 0) break;
    result.num_collapsed += pass.num_collapsed();
    result.num_divided += pass.num_divided();
    static_cast<DerivedMesh&>(result) = compose(result, pass.result());
  }
  return result;
}

}  // namespace weft::engine
