#include "weft/mesh/polygon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace weft::engine {
namespace {

using Positions = std::vector<Vec3>;

/// Newell's normal: perpendicular to the best-fitting plane, with length twice the area.
Vec3 polygon_normal(const Positions& x) {
  Vec3 normal = Vec3::Zero();
  for (size_t k = 1; k + 1 < x.size(); ++k) normal += (x[k] - x[0]).cross(x[k + 1] - x[0]);
  return normal;
}

/// The vertices of a polygon by the cells of a grid in its plane. The grid of a polygon without one is one cell.
class VertexGrid {
 public:
  VertexGrid(const Positions& x, const Vec3& normal) {
    constexpr std::size_t kLeast = 64;     // vertices for more than one cell
    constexpr double kVerticesOfCell = 2;  // on average [1]
    const bool has_plane = normal.allFinite() && normal.stableNorm() > 0;
    if (has_plane && x.size() >= kLeast) {
      axes_.row(0) = normal.stableNormalized().unitOrthogonal();
      axes_.row(1) = normal.stableNormalized().cross(axes_.row(0));
      side_ = static_cast<int>(std::sqrt(static_cast<double>(x.size()) / kVerticesOfCell));
      low_ = high_ = axes_ * x[0];
      for (const Vec3& p : x) {
        low_ = low_.cwiseMin(axes_ * p);
        high_ = high_.cwiseMax(axes_ * p);
      }
      if (!(high_ - low_).allFinite()) side_ = 1;
    }
    cells_.resize(static_cast<std::size_t>(side_) * side_);
    for (std::size_t v = 0; v < x.size(); ++v) {
      const auto [i, j] = cell_of(axes_ * x[v]);
      cells_[i * side_ + j].push_back(static_cast<int>(v));
    }
  }

  /// The first vertex, in the order of cells, that `accepts`, of those near the points; -1: none. Near are those
  /// in the triangle of the points when it is `scale` times as large.
  template <class Accepts>
  int find_near(const std::array<Vec3, 3>& points, double scale, const Accepts& accepts) const {
    constexpr double kRounding = 1e-9;  // of the polygon's size [1]
    const std::array<Eigen::Vector2d, 3> p = {axes_ * points[0], axes_ * points[1], axes_ * points[2]};
    const Eigen::Vector2d middle = (p[0] + p[1] + p[2]) / 3, slack = kRounding * (high_ - low_);
    Eigen::Vector2d low = p[0], high = p[0];
    for (const Eigen::Vector2d& corner : p) {
      low = low.cwiseMin(middle + scale * (corner - middle));
      high = high.cwiseMax(middle + scale * (corner - middle));
    }
    const auto [i0, j0] = cell_of(low - slack);
    const auto [i1, j1] = cell_of(high + slack);
    for (int i = i0; i <= i1; ++i) {
      for (int j = j0; j <= j1; ++j) {
        for (const int v : cells_[i * side_ + j]) {
          if (accepts(v)) return v;
        }
      }
    }
    return -1;
  }

 private:
  std::pair<int, int> cell_of(const Eigen::Vector2d& p) const {
    const auto along = [&](int axis) {
      const double share = (p[axis] - low_[axis]) / (high_[axis] - low_[axis]);
      return share > 0 ? static_cast<int>(std::min<double>(side_ - 1, share * side_)) : 0;
    };
    return {along(0), along(1)};
  }

  Eigen::Matrix<double, 2, 3> axes_ = Eigen::Matrix<double, 2, 3>::Zero();
  Eigen::Vector2d low_ = Eigen::Vector2d::Zero(), high_ = Eigen::Vector2d::Zero();
  int side_ = 1;                         // cells along each axis
  std::vector<std::vector<int>> cells_;  // (side × side)
};

/// Ear clipping. An ear is a convex corner whose triangle contains none of the other vertices; only an ear can be
/// clipped. The ear with the shortest cut is first, of equal ones the first of the polygon.
///
/// Corners are tested in the order of their cuts. One that is no ear waits for the vertex in its triangle to be
/// clipped, or for a new neighbour.
class EarClipper {
 public:
  explicit EarClipper(const Positions& x)
      : x_(x),
        normal_(polygon_normal(x)),
        tolerance_(1e-12 * normal_.squaredNorm()),  // round-off: a vertex on the cut counts as inside
        grid_(x, normal_),
        corners_(x.size()) {
    const int n = static_cast<int>(x.size());
    for (int k = 0; k < n; ++k) corners_[k] = {.previous = (k + n - 1) % n, .next = (k + 1) % n};
    for (int k = 0; k < n; ++k) add_candidate(k);
  }

  /// The n - 2 triangles, as numbers of the corners.
  std::vector<Triangle> cut() {
    std::vector<Triangle> triangles;
    while (triangles.size() + 3 < x_.size()) {
      const int tip = find_best_ear();
      triangles.push_back(triangle_at(tip));
      clip(tip);
    }
    triangles.push_back(triangle_at(corners_[first_].next));
    return triangles;
  }

 private:
  struct Corner {
    int previous = 0, next = 0;
    int version = 0;        // counts its neighbours
    int last_waiting = -1;  // in `waiting_`, for this vertex
    bool is_clipped = false;
  };
  /// A corner that is no ear while a vertex is there.
  struct Waiting {
    int corner, version;
    int before;  // the one that waits for the same vertex; -1: none
  };
  struct Candidate {
    double cut_sq;
    int corner, version;
    auto operator<=>(const Candidate&) const = default;
  };

  Triangle triangle_at(int tip) const { return {corners_[tip].previous, tip, corners_[tip].next}; }

  double side(int from, int to, int v) const {
    return normal_.dot((x_[to] - x_[from]).cross(x_[v] - x_[from]));
  }

  void add_candidate(int tip) {
    const auto [a, b, c] = triangle_at(tip);
    const double cut_sq = (x_[a] - x_[c]).squaredNorm();
    const bool is_convex = side(a, b, c) > tolerance_;
    if (is_convex && cut_sq < std::numeric_limits<double>::infinity())
      candidates_.push({cut_sq, tip, corners_[tip].version});
  }

  /// A vertex in the triangle of a convex corner; -1: none.
  int find_vertex_in(int tip) const {
    const auto [a, b, c] = triangle_at(tip);
    const double scale = 1 + 3 * tolerance_ / side(a, b, c);  // all sides >= -tolerance
    return grid_.find_near({x_[a], x_[b], x_[c]}, scale, [&, a = a, b = b, c = c](int v) {
      if (corners_[v].is_clipped || x_[v] == x_[a] || x_[v] == x_[b] || x_[v] == x_[c]) return false;
      return std::min({side(a, b, v), side(b, c, v), side(c, a, v)}) >= -tolerance_;
    });
  }

  /// The second corner of a polygon without ears (self-intersecting, no area).
  int find_best_ear() {
    while (!candidates_.empty()) {
      const Candidate best = candidates_.top();
      candidates_.pop();
      if (corners_[best.corner].is_clipped || corners_[best.corner].version != best.version) continue;
      const int inside = find_vertex_in(best.corner);
      if (inside < 0) return best.corner;
      waiting_.push_back({best.corner, best.version, corners_[inside].last_waiting});
      corners_[inside].last_waiting = static_cast<int>(waiting_.size()) - 1;
    }
    return corners_[first_].next;
  }

  void clip(int tip) {
    Corner& clipped = corners_[tip];
    clipped.is_clipped = true;
    if (first_ == tip) first_ = clipped.next;
    corners_[clipped.previous].next = clipped.next;
    corners_[clipped.next].previous = clipped.previous;
    for (const int neighbour : {clipped.previous, clipped.next}) {
      ++corners_[neighbour].version;
      add_candidate(neighbour);
    }
    for (int k = clipped.last_waiting; k >= 0; k = waiting_[k].before) {
      const auto [corner, version, before] = waiting_[k];
      if (!corners_[corner].is_clipped && corners_[corner].version == version) add_candidate(corner);
    }
  }

  const Positions& x_;
  const Vec3 normal_;
  const double tolerance_;
  VertexGrid grid_;
  std::vector<Corner> corners_;
  int first_ = 0;  // corner that is left
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> candidates_;
  std::vector<Waiting> waiting_;
};

}  // namespace

std::vector<Triangle> triangulate(const std::vector<Vec3>& x) {
  if (x.size() == 3) return {{0, 1, 2}};
  return EarClipper(x).cut();
}

}  // namespace weft::engine
