#include "weft/verify/crossings.h"

#include <algorithm>
#include <utility>

#include "weft/verify/predicates.h"
#include "weft/verify/sweep.h"

namespace weft::engine::verify {
namespace {

// ---- One pair ----

/// Sides of another triangle's plane on which three corners lie.
struct Sides {
  std::array<int, 3> of;  // orient3d of each corner

  int count(int side) const { return static_cast<int>(std::count(of.begin(), of.end(), side)); }
  bool is_on_both() const { return count(1) > 0 && count(-1) > 0; }
  bool has_edge_in_plane() const { return count(0) == 2; }
};

Sides sides_of(const Corners& corners, const Corners& plane) {
  const auto& [a, b, c] = plane;
  return {{orient3d(a, b, c, corners[0]), orient3d(a, b, c, corners[1]), orient3d(a, b, c, corners[2])}};
}

/// The corner that is alone on its side.
int lonely_corner(const Sides& sides) {
  for (int k = 0; k < 3; ++k) {
    const int side = sides.of[k];
    if (side != 0 && sides.of[(k + 1) % 3] != side && sides.of[(k + 2) % 3] != side) return k;
  }
  return 0;
}

/// Both triangles have corners strictly on both sides of the other's plane. Each therefore cuts an interval
/// out of the intersection line of the planes, by the two edges at its lonely corner:
///
///            a0                      With each lonely corner on the positive side of the other triangle
///            /\                      (flipping that one if necessary), the order of the
///     ------/--\--------o====o----   intervals' ends is that of two orientations (Guigue and
///          /    \                    Devillers 2003).
///         a1    a2
bool intervals_overlap(const Corners& a, const Sides& sides_a, const Corners& b, const Sides& sides_b) {
  const int i = lonely_corner(sides_a), j = lonely_corner(sides_b);
  const Vec3 &a0 = a[i], &b0 = b[j];
  const Vec3 *a1 = &a[(i + 1) % 3], *a2 = &a[(i + 2) % 3], *b1 = &b[(j + 1) % 3], *b2 = &b[(j + 2) % 3];
  if (sides_a.of[i] < 0) std::swap(b1, b2);
  if (sides_b.of[j] < 0) std::swap(a1, a2);
  return orient3d(a0, *a1, b0, *b1) < 0 && orient3d(a0, *a2, *b2, b0) < 0;
}

/// Kind of intersection of a pair: crossing, or a degenerate case decided by adjacent triangles.
enum class Meeting { none, crossing, edge_of_a_in_b, edge_of_b_in_a, edge_on_edge };

/// The edge of a that is in b's plane, by the corner opposite to it.
int corner_off_plane(const Sides& sides) { return sides.of[0] != 0 ? 0 : sides.of[1] != 0 ? 1 : 2; }

/// Whether a's edge, which is in b's plane, runs through b's interior. b has corners on both sides of the
/// edge's line, so only a side of b can separate them. Sides are tested in space, by planes through a's
/// corner off the plane.
bool edge_runs_inside(const Corners& a, const Sides& sides_a, const Corners& b) {
  const int apex = corner_off_plane(sides_a);
  const Vec3 &top = a[apex], &from = a[(apex + 1) % 3], &to = a[(apex + 2) % 3];
  for (int k = 0; k < 3; ++k) {
    const Vec3 &p = b[k], &q = b[(k + 1) % 3];
    const int inner = orient3d(p, q, top, b[(k + 2) % 3]);
    if (orient3d(p, q, top, from) != inner && orient3d(p, q, top, to) != inner) return false;
  }
  return true;
}

/// Whether two collinear edges share more than a point.
bool edges_overlap(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) {
  const int axis = a0.x() != a1.x() ? 0 : a0.y() != a1.y() ? 1 : 2;
  const auto [a_low, a_high] = std::minmax(a0[axis], a1[axis]);
  const auto [b_low, b_high] = std::minmax(b0[axis], b1[axis]);
  return std::max(a_low, b_low) < std::min(a_high, b_high);
}

bool edges_overlap(const Corners& a, const Sides& sides_a, const Corners& b, const Sides& sides_b) {
  const int i = corner_off_plane(sides_a), j = corner_off_plane(sides_b);
  return edges_overlap(a[(i + 1) % 3], a[(i + 2) % 3], b[(j + 1) % 3], b[(j + 2) % 3]);
}

struct MeetingOfPair {
  Meeting meeting = Meeting::none;
  Sides sides_a, sides_b;
};

MeetingOfPair meet(const Corners& a, const Corners& b) {
  MeetingOfPair result;
  Sides& sides_a = result.sides_a = sides_of(a, b);
  if (!sides_a.is_on_both() && !sides_a.has_edge_in_plane()) return result;
  Sides& sides_b = result.sides_b = sides_of(b, a);
  if (!sides_b.is_on_both() && !sides_b.has_edge_in_plane()) return result;

  if (sides_a.is_on_both() && sides_b.is_on_both()) {
    if (intervals_overlap(a, sides_a, b, sides_b)) result.meeting = Meeting::crossing;
  } else if (sides_b.is_on_both()) {
    if (edge_runs_inside(a, sides_a, b)) result.meeting = Meeting::edge_of_a_in_b;
  } else if (sides_a.is_on_both()) {
    if (edge_runs_inside(b, sides_b, a)) result.meeting = Meeting::edge_of_b_in_a;
  } else if (edges_overlap(a, sides_a, b, sides_b)) {
    result.meeting = Meeting::edge_on_edge;
  }
  return result;
}

// ---- Cases decided by adjacent triangles ----

struct EdgeId {
  int surface, low, high;  // vertices, low < high

  auto operator<=>(const EdgeId&) const = default;
};

/// An edge of one surface runs through the interior of a triangle of the other; `side` is the side of that
/// triangle's plane on which a triangle at the edge lies.
struct EdgeInTriangle {
  EdgeId edge;
  TriangleId crossed;
  int side;
  Crossing pair;

  auto operator<=>(const EdgeInTriangle&) const = default;
};

/// Edges of two surfaces overlap; `pair` are triangles at them, and these are their third corners.
struct EdgeOnEdge {
  EdgeId first, second;
  int wing_first, wing_second;
  Crossing pair;

  auto operator<=>(const EdgeOnEdge&) const = default;
};

/// Calls visit(begin, end) for each run of equal keys in a sorted list.
template <class Item, class Key, class Visit>
void for_each_group(const std::vector<Item>& items, Key key, Visit visit) {
  for (auto begin = items.begin(); begin != items.end();) {
    const auto end =
        std::find_if(begin, items.end(), [&](const Item& item) { return key(item) != key(*begin); });
    visit(begin, end);
    begin = end;
  }
}

/// Directions around an axis, viewed along it.
struct Around {
  const Vec3 &from, &to;  // the axis

  /// Positive if a turn of less than 180° leads from p to q.
  int turn(const Vec3& p, const Vec3& q) const { return orient3d(from, to, p, q); }

  /// Strictly between `first` and `last` in the positive sense of rotation.
  bool is_between(const Vec3& p, const Vec3& first, const Vec3& last) const {
    const int before = turn(first, p), after = turn(p, last);
    if (turn(first, last) >= 0) return before > 0 && after > 0;
    return !(before <= 0 && after <= 0);
  }

  bool separates(const Vec3& s, const Vec3& t, const Vec3& u, const Vec3& w) const {
    return (is_between(u, s, t) && is_between(w, t, s)) || (is_between(w, s, t) && is_between(u, t, s));
  }
};

// ---- All pairs ----

Sweep boxes_of(std::span<const SurfaceView> surfaces) {
  std::vector<Sweep::Box> boxes;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const SurfaceView& view = surfaces[s];
    for (std::size_t t = 0; t < view.triangles.size(); ++t) {
      const auto& [a, b, c] = view.triangles[t];
      const Vec3 &x = view.positions[a], &y = view.positions[b], &z = view.positions[c];
      boxes.emplace_back(x.cwiseMin(y).cwiseMin(z).cast<float>(), x.cwiseMax(y).cwiseMax(z).cast<float>(),
                         TriangleId{static_cast<int>(s), static_cast<int>(t)});
    }
  }
  return Sweep(std::move(boxes));
}

class Finder {
 public:
  explicit Finder(std::span<const SurfaceView> surfaces) : surfaces_(surfaces) {}

  std::vector<Crossing> find() {
    boxes_of(surfaces_).for_each_pair([this](TriangleId p, TriangleId q) { test(p, q); });
    test_edges_in_triangles();
    test_edges_on_edges();
    std::sort(crossings_.begin(), crossings_.end());
    return std::move(crossings_);
  }

 private:
  bool is_cloth(TriangleId id) const { return surfaces_[id.surface].is_cloth; }
  const Triangle& vertices(TriangleId id) const { return surfaces_[id.surface].triangles[id.triangle]; }
  const Vec3& position(int surface, int vertex) const { return surfaces_[surface].positions[vertex]; }

  Corners corners(TriangleId id) const {
    const auto& [a, b, c] = vertices(id);
    return {position(id.surface, a), position(id.surface, b), position(id.surface, c)};
  }

  bool share_an_edge(TriangleId p, TriangleId q) const {
    if (p.surface != q.surface) return false;
    int shared = 0;
    for (const int v : vertices(p)) {
      for (const int w : vertices(q)) shared += v == w;
    }
    return shared >= 2;
  }

  /// The edge opposite to a corner.
  EdgeId edge(TriangleId id, int corner) const {
    const Triangle& t = vertices(id);
    const auto [low, high] = std::minmax(t[(corner + 1) % 3], t[(corner + 2) % 3]);
    return {id.surface, low, high};
  }

  void test(TriangleId a, TriangleId b) {
    if (!is_cloth(a) && !is_cloth(b)) return;
    if (share_an_edge(a, b)) return;
    if (is_cloth(a) == is_cloth(b) ? b < a : is_cloth(b)) std::swap(a, b);
    const auto [meeting, sides_a, sides_b] = meet(corners(a), corners(b));
    const Crossing pair{a, b};
    switch (meeting) {
      case Meeting::none:
        break;
      case Meeting::crossing:
        crossings_.push_back(pair);
        break;
      case Meeting::edge_of_a_in_b:
        add_edge_in_triangle(a, sides_a, b, pair);
        break;
      case Meeting::edge_of_b_in_a:
        add_edge_in_triangle(b, sides_b, a, pair);
        break;
      case Meeting::edge_on_edge:
        add_edge_on_edge(a, corner_off_plane(sides_a), b, corner_off_plane(sides_b), pair);
    }
  }

  void add_edge_in_triangle(TriangleId a, const Sides& sides, TriangleId crossed, const Crossing& pair) {
    const int apex = corner_off_plane(sides);
    in_triangles_.push_back({edge(a, apex), crossed, sides.of[apex], pair});
  }

  void add_edge_on_edge(TriangleId a, int apex_a, TriangleId b, int apex_b, const Crossing& pair) {
    EdgeOnEdge touch{edge(a, apex_a), edge(b, apex_b), vertices(a)[apex_a], vertices(b)[apex_b], pair};
    if (touch.second < touch.first) {
      std::swap(touch.first, touch.second);
      std::swap(touch.wing_first, touch.wing_second);
    }
    on_edges_.push_back(touch);
  }

  /// Case 2: one edge, one triangle, and adjacent triangles on both of its sides.
  void test_edges_in_triangles() {
    std::sort(in_triangles_.begin(), in_triangles_.end());
    const auto key = [](const EdgeInTriangle& item) { return std::pair(item.edge, item.crossed); };
    for_each_group(in_triangles_, key, [this](auto begin, auto end) {
      if (begin->side != std::prev(end)->side) crossings_.push_back(first_pair(begin, end));
    });
  }

  /// Case 3: two edges, and adjacent triangles that alternate around them.
  void test_edges_on_edges() {
    std::sort(on_edges_.begin(), on_edges_.end());
    const auto key = [](const EdgeOnEdge& item) { return std::pair(item.first, item.second); };
    for_each_group(on_edges_, key, [this](auto begin, auto end) {
      if (wings_alternate(begin, end)) crossings_.push_back(first_pair(begin, end));
    });
  }

  template <class Iterator>
  static Crossing first_pair(Iterator begin, Iterator end) {
    return std::min_element(begin, end, [](const auto& p, const auto& q) { return p.pair < q.pair; })->pair;
  }

  template <class Iterator>
  bool wings_alternate(Iterator begin, Iterator end) const {
    const auto& [s1, low, high] = begin->first;
    const int s2 = begin->second.surface;
    const Around axis{position(s1, low), position(s1, high)};
    for (auto i = begin; i != end; ++i) {
      for (auto j = std::next(i); j != end; ++j) {
        for (auto k = begin; k != end; ++k) {
          for (auto l = begin; l != end; ++l) {
            if (axis.separates(position(s1, i->wing_first), position(s1, j->wing_first),
                               position(s2, k->wing_second), position(s2, l->wing_second))) {
              return true;
            }
          }
        }
      }
    }
    return false;
  }

  std::span<const SurfaceView> surfaces_;
  std::vector<Crossing> crossings_;
  std::vector<EdgeInTriangle> in_triangles_;
  std::vector<EdgeOnEdge> on_edges_;
};

}  // namespace

bool insides_cross(const Corners& a, const Corners& b) { return meet(a, b).meeting == Meeting::crossing; }

std::vector<Crossing> find_crossings(std::span<const SurfaceView> surfaces) {
  return Finder(surfaces).find();
}

}  // namespace weft::engine::verify
