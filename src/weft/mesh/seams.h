#pragma once
/// Private to mesh/: which stretches of borders are to be sewn to which, and point by point how.
///
/// A seam is found like a zip. It starts where two borders are nearest and runs both ways along them:
///
///      a0-----a1----*-----a2          at a0|b0: a1 lies beside the edge b0–b1, which is divided there (*);
///       |      |    |     |           then b1 lies beside a1–a2, which is divided; a2 and b2 lie within a
///       third
///      b0------*---b1-----b2          of the shortest edge there: they become one without dividing anything
///
/// Both ends only go forward, and each at least a quarter as fast as the other: the order of the points is
/// never mixed up, however short edges are against the distance and whichever border has more of them.

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "weft/mesh/borders.h"

namespace weft::engine {

/// A point of a border: on the part of an edge from a node to the next.
struct BorderPlace {
  int node = 0;
  double t = 0;  // share of that part, in [0, 1); 0 is the node itself [1]
  bool operator==(const BorderPlace&) const = default;
};

/// Two points that become one.
struct Stitch {
  BorderPlace a, b;
  bool operator==(const Stitch&) const = default;
};

struct SeamMeasures {
  double length = 0;  // [m]
  double gap = 0;     // largest distance of a point from the other border [m]
  double fold = 0;    // ∫ cosine of the angle between the pieces: -1 flat, 1 one on the other [m]

  void add(const SeamMeasures& other) {
    length += other.length;
    gap = std::max(gap, other.gap);
    fold += other.fold;
  }
};

struct Seam {
  std::vector<Stitch> stitches;  // from one end to the other
  int direction_b = 1;           // a goes along its border; b does (1) or runs against its own (-1)
  bool is_closed = false;        // the last stitch is followed by the first
  int num_divided = 0;           // points at which edges were divided for it
  SeamMeasures measures = {};
};

/// What has been sewn so far.
class SeamFinder {
 public:
  SeamFinder(const TriangleMesh& mesh, double distance);

  /// Finds and sews seams until there are none left; deterministic. Each stretch of border is sewn once, to
  /// the nearest other one.
  void sew_all();

  const Borders& borders() const { return borders_; }
  const std::vector<Seam>& seams() const { return seams_; }

  /// For each vertex of the mesh and of divided edges the lowest one that it is sewn to.
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

  /// The step from a stitch to the next, and what it says about the seam.
  struct Step {
    Stitch to;
    double gap = 0;       // [m]
    bool closes = false;  // nothing comes after it
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
  std::vector<char> is_sewn_;                // (nodes) the part of an edge from the node to the next
  std::vector<int> group_;                   // (vertices)
  std::vector<std::vector<int>> members_;    // (vertices) of the group, at its lowest vertex
  std::vector<int> node_of_vertex_;          // (vertices) of borders; -1 of others
  std::vector<std::vector<int>> triangles_;  // (vertices) at a border: the triangles around it
  std::set<std::pair<int, int>> tried_;      // pairs of BorderEdges, the lower one first
  std::vector<Seam> seams_;
};

}  // namespace weft::engine
