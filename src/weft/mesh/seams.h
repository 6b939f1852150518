#pragma once
/// Private to mesh/: seams between stretches of borders, and their pairs of points.
///
/// A seam is found like a zip. It starts where two borders are nearest and runs both ways along them:
///
///      a0-----a1----*-----a2          at a0|b0: a1 is next to the edge b0–b1, which is divided there (*);
///       |      |    |     |           then b1 is next to a1–a2, which is divided; a2 and b2 are within
///      b0------*---b1-----b2          ⅓ of the shortest edge there: they merge without a division
///
/// Both ends only move forward, each at least a quarter as fast as the other: the order of the points is
/// preserved, for any ratio of edge length to distance and whichever border has more edges.

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "weft/mesh/borders.h"

namespace weft::engine {

/// A point of a border: on the part of an edge from a node to the next.
struct BorderPlace {
  int node = 0;
  double t = 0;  // share of that part, in [0, 1); 0 is the node [1]
  bool operator==(const BorderPlace&) const = default;
};

/// Two points to merge.
struct Stitch {
  BorderPlace a, b;
  bool operator==(const Stitch&) const = default;
};

struct SeamMeasures {
  double length = 0;  // [m]
  double gap = 0;     // largest distance of a point from the other border [m]
  double fold = 0;    // ∫ cosine of the angle between the pieces: -1 flat, 1 folded [m]

  void add(const SeamMeasures& other) {
    length += other.length;
    gap = std::max(gap, other.gap);
    fold += other.fold;
  }
};

struct Seam {
  std::vector<Stitch> stitches;  // from one end to the other
  int direction_b = 1;           // a follows its border; b follows (1) or opposes its own (-1)
  bool is_closed = false;        // the first stitch follows the last
  int num_divided = 0;           // points at which edges were divided for it
  SeamMeasures measures = {};
};

/// State of the sewing.
class SeamFinder {
 public:
  SeamFinder(const TriangleMesh& mesh, double distance);

  /// Finds and sews all seams; deterministic. Each stretch of border is sewn once, to the nearest other one.
  void sew_all();

  const Borders& borders() const { return borders_; }
  const std::vector<Seam>& seams() const { return seams_; }

  /// For each vertex, including those of divided edges, the lowest one that it is sewn to.
  const std::vector<int>& groups() const { return group_; }
  Vec3 mean_position(const std::vector<int>& vertices) const;
  const std::vector<int>& members(int group) const { return members_[group]; }
  bool is_at_border(int vertex) const { return node_of_vertex_[vertex] >= 0; }

 private:
  struct Seed {
    double distance;             // from the node to the other edge [m]
    int edge, node, other_edge;  // nodes; `node` is an end of `edge`
    auto operator<=>(const Seed&) const = default;
  };

  /// Step from one stitch to the next, with its measures of the seam.
  struct Step {
    Stitch to;
    double gap = 0;       // [m]
    bool closes = false;  // the seam ends there
  };

  struct Run {
    std::vector<Stitch> stitches;  // without the start
    SeamMeasures measures = {};
    bool is_closed = false;
  };

  std::vector<Seed> find_seeds() const;
  bool may_sew(int edge_a, int edge_b) const;
  bool may_sew_to_itself(int edge_a, int edge_b) const;
  void try_seam(const Seed& seed);
  Seam find_seam(const Seed& seed) const;
  Stitch make_start(const Seed& seed) const;
  Run run_along(const Stitch& start, int direction_a, int direction_b) const;
  bool may_go_on(int edge_a, int edge_b) const;
  bool find_step(const Stitch& start, const Stitch& at, int direction_a, int direction_b, Step& step) const;
  bool become_one(const Stitch& start, const BorderPlace& a, const BorderPlace& b) const;
  double find_gap(const Vec3& p, const BorderPlace& place) const;
  void sew(Seam& seam);
  void divide_at(std::vector<BorderPlace*> places);
  bool unite(int vertex_a, int vertex_b);
  void add_divided(int node, int divided);
  bool may_unite(const std::vector<int>& group_a, const std::vector<int>& group_b,
                 const std::vector<int>& all) const;
  bool share_triangle(int vertex_a, int vertex_b) const;

  Vec3 position_of(int vertex) const;
  Vec3 position(const BorderPlace& place) const;
  int edge_ahead(const BorderPlace& place, int direction) const;
  BorderPlace next_place(const BorderPlace& place, int direction, const BorderPlace& start) const;
  BorderPlace between(const BorderPlace& place, int direction, double share) const;
  double shortest_edge_at(const BorderPlace& place) const;

  const double distance_;
  Borders borders_;
  std::vector<char> is_sewn_;                // (nodes) whether the part from the node to the next is sewn
  std::vector<int> group_;                   // (vertices)
  std::vector<std::vector<int>> members_;    // (vertices) members of the group, at its lowest vertex
  std::vector<int> node_of_vertex_;          // (vertices) on borders; -1 elsewhere
  std::vector<std::vector<int>> triangles_;  // (vertices) at a border: its triangles
  std::set<std::pair<int, int>> tried_;      // pairs of BorderEdges, the lower one first
  std::vector<Seam> seams_;
};

}  // namespace weft::engine
