#include "weft/mesh/border_path.h"

#include <cmath>
#include <string>

#include "weft/error.h"
#include "weft/mesh/borders.h"

namespace weft::engine {
namespace {

struct Way {
  std::vector<int> vertices;  // without the first
  double length = 0;          // [m]
};

/// From the node to a vertex, forwards or backwards; empty if the border does not lead there.
Way walk(const TriangleMesh& mesh, const Borders& borders, int start, int vertex, bool forwards) {
  Way way;
  for (int n = start;;) {
    const int from = borders.nodes[n].vertex;
    n = forwards ? borders.nodes[n].next : borders.nodes[n].previous;
    if (n < 0 || n == start) return {};
    const int to = borders.nodes[n].vertex;
    way.length += (mesh.positions[to] - mesh.positions[from]).norm();
    way.vertices.push_back(to);
    if (to == vertex) return way;
  }
}

std::string name(int vertex) { return "vertex " + std::to_string(vertex); }

/// The shorter way between two vertices, over all borders that meet both.
Way find_way(const TriangleMesh& mesh, const Borders& borders, int from, int to) {
  constexpr double kEqual = 1e-6;
  Way best;
  bool is_on_border = false, is_ambiguous = false;
  for (int n = 0; n < static_cast<int>(borders.nodes.size()); ++n) {
    if (borders.nodes[n].vertex != from) continue;
    is_on_border = true;
    for (const bool forwards : {true, false}) {
      Way way = walk(mesh, borders, n, to, forwards);
      if (way.vertices.empty()) continue;
      if (!best.vertices.empty() && std::abs(way.length - best.length) < kEqual * best.length) {
        is_ambiguous = way.vertices != best.vertices;
      } else if (best.vertices.empty() || way.length < best.length) {
        best = std::move(way);
        is_ambiguous = false;
      }
    }
  }
  if (!is_on_border) throw InputError(name(from) + " is not on a border");
  if (best.vertices.empty()) throw InputError(name(to) + " is not on the border of " + name(from));
  if (is_ambiguous)
    throw InputError("both ways along the border from " + name(from) + " to " + name(to) +
                     " are equally long; name a vertex between them");
  return best;
}

}  // namespace

BorderPaths::BorderPaths(const TriangleMesh& mesh)
    : mesh_(mesh), borders_(std::make_unique<const Borders>(build_borders(mesh))) {}

BorderPaths::~BorderPaths() = default;

std::vector<int> BorderPaths::find(std::span<const int> stops) const {
  if (stops.size() < 2) throw InputError("a stretch of border has at least two vertices");
  std::vector<int> path = {stops[0]};
  for (std::size_t k = 1; k < stops.size(); ++k) {
    if (stops[k] == stops[k - 1]) throw InputError(name(stops[k]) + " is named twice in a row");
    const Way way = find_way(mesh_, *borders_, stops[k - 1], stops[k]);
    path.insert(path.end(), way.vertices.begin(), way.vertices.end());
  }
  return path;
}

}  // namespace weft::engine
