#include "weft/mesh/sew.h"

#include <algorithm>
#include <numeric>

#include "weft/mesh/divide.h"
#include "weft/mesh/seams.h"

namespace weft::engine {
namespace {

/// Intermediate mesh: divided, its vertices not yet joined.
struct Pieces {
  DividedTriangles divided;
  std::vector<int> group;      // (vertices) lowest vertex of each vertex's group
  std::vector<Vec3> position;  // (vertices) of the group, at its lowest vertex [m]
};

Pieces divide_and_group(const TriangleMesh& mesh, const SeamFinder& finder) {
  std::vector<EdgePoint> points;
  for (const BorderNode& n : finder.borders().nodes) {
    if (n.t == 0) continue;
    const BorderEdge& edge = finder.borders().edges[n.edge];
    points.push_back({edge.a, edge.b, n.t, n.vertex});
  }
  Pieces pieces{divide_edges(make_undivided(mesh.triangles), points), finder.groups(), mesh.positions};
  pieces.position.resize(pieces.group.size());
  for (int v = 0; v < static_cast<int>(pieces.group.size()); ++v) {
    if (pieces.group[v] == v && finder.is_at_border(v))
      pieces.position[v] = finder.mean_position(finder.members(v));
  }
  return pieces;
}

Triangle joined(const Triangle& t, const std::vector<int>& group) {
  return {group[t[0]], group[t[1]], group[t[2]]};
}

/// Drops triangles between merged points of an edge.
void drop_collapsed(Pieces& pieces) {
  DividedTriangles& d = pieces.divided;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < d.triangles.size(); ++t) {
    const auto [a, b, c] = joined(d.triangles[t], pieces.group);
    if (a == b || b == c || c == a) continue;
    d.triangles[kept] = d.triangles[t];
    d.source[kept] = d.source[t];
    d.weights[kept++] = d.weights[t];
  }
  d.triangles.resize(kept);
  d.source.resize(kept);
  d.weights.resize(kept);
}

/// Edges inside different pieces that now connect the same two vertices: all but one of them are divided, so
/// that each keeps its own two triangles.
std::vector<EdgePoint> find_doubled_edges(const Pieces& pieces) {
  const std::vector<int>& group = pieces.group;
  std::vector<Edge> edges = build_edges({{}, pieces.divided.triangles});
  const auto key = [&](const Edge& e) { return std::minmax({group[e.a], group[e.b]}); };
  std::stable_sort(edges.begin(), edges.end(), [&](const Edge& l, const Edge& r) {
    return std::pair(key(l), l.num_triangles) < std::pair(key(r), r.num_triangles);
  });
  std::vector<EdgePoint> points;
  int next_vertex = static_cast<int>(group.size());
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    while (end < edges.size() && key(edges[end]) == key(edges[i])) ++end;
    for (std::size_t e = i + 1; e < end; ++e) {
      if (edges[e].num_triangles >= 2) points.push_back({edges[e].a, edges[e].b, 0.5, next_vertex++});
    }
  }
  return points;
}

void divide_doubled_edges(Pieces& pieces) {
  while (true) {
    const std::vector<EdgePoint> points = find_doubled_edges(pieces);
    if (points.empty()) return;
    for (const EdgePoint& p : points) {
      pieces.position.push_back(0.5 *
                                (pieces.position[pieces.group[p.a]] + pieces.position[pieces.group[p.b]]));
      pieces.group.push_back(p.vertex);
    }
    pieces.divided = divide_edges(pieces.divided, points);
  }
}

/// Joins the vertices and compacts their indices.
SewnMesh join(Pieces& pieces, int num_source) {
  std::vector<int> index(pieces.group.size(), -1);
  for (const Triangle& t : pieces.divided.triangles) {
    for (const int v : joined(t, pieces.group)) index[v] = 0;
  }
  SewnMesh result;
  for (std::size_t v = 0; v < index.size(); ++v) {
    if (index[v] < 0) continue;
    index[v] = result.mesh.num_vertices();
    result.mesh.positions.push_back(pieces.position[v]);
  }
  for (const Triangle& t : pieces.divided.triangles) {
    const auto [a, b, c] = joined(t, pieces.group);
    result.mesh.triangles.push_back({index[a], index[b], index[c]});
  }
  for (int v = 0; v < num_source; ++v) result.vertex_of_source.push_back(index[pieces.group[v]]);
  result.source_triangle = std::move(pieces.divided.source);
  result.corner_weights = std::move(pieces.divided.weights);
  return result;
}

int count_joined(const SeamFinder& finder, int num_source) {
  int count = 0;
  for (int v = 0; v < num_source; ++v) count += finder.members(finder.groups()[v]).size() > 1;
  return count;
}

int count_divided(const Borders& borders) {
  std::vector<char> is_divided(borders.edges.size(), 0);
  for (const BorderNode& n : borders.nodes) {
    if (n.t > 0) is_divided[n.edge] = 1;
  }
  return static_cast<int>(std::count(is_divided.begin(), is_divided.end(), 1));
}

/// Whether the seam joins two borders of one piece over its cloth.
bool is_across_cloth(const Borders& borders, const Seam& seam) {
  return std::ranges::any_of(seam.stitches, [&](const Stitch& stitch) {
    const BorderNode &a = borders.nodes[stitch.a.node], &b = borders.nodes[stitch.b.node];
    const BorderEdge &at_a = borders.edge_at(a), &at_b = borders.edge_at(b);
    return at_a.piece == at_b.piece && is_across_cloth(at_a, at_b, b.position - a.position);
  });
}

}  // namespace

SewnMesh sew_borders(const TriangleMesh& mesh, double distance) {
  SeamFinder finder(mesh, distance);
  finder.sew_all();
  Pieces pieces = divide_and_group(mesh, finder);
  drop_collapsed(pieces);
  divide_doubled_edges(pieces);
  SewnMesh result = join(pieces, mesh.num_vertices());
  result.num_seams = static_cast<int>(finder.seams().size());
  result.num_joined = count_joined(finder, mesh.num_vertices());
  result.num_divided = count_divided(finder.borders());
  return result;
}

OpenSeams find_open_seams(const TriangleMesh& mesh, double distance) {
  SeamFinder finder(mesh, distance);
  finder.sew_all();
  const Borders& borders = finder.borders();
  OpenSeams open;
  for (const Seam& seam : finder.seams()) {
    if (seam.measures.gap == 0 && seam.num_divided == 0) continue;  // its vertices coincide
    if (is_across_cloth(borders, seam)) continue;
    ++open.num_seams;
    open.gap = std::max(open.gap, seam.measures.gap);
  }
  return open;
}

}  // namespace weft::engine
