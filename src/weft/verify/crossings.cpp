#include "weft/verify/crossings.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include "weft/verify/predicates.h"

namespace weft::verify {
namespace {

// ---- One pair ----

/// On which side of another triangle's plane three corners lie.
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

/// The corner that has no other on its side.
int lonely_corner(const Sides& sides) {
  for (int k = 0; k < 3; ++k) {
    const int side = sides.of[k];
    if (side != 0 && sides.of[(k + 1) % 3] != side && sides.of[(k + 2) % 3] != side) return k;
  }
  return 0;
}

/// Both triangles have corners strictly on both sides of the other's plane, so each cuts an interval out of
/// the line in which the planes meet, by the two edges at its lonely corner:
///
///            a0                      Once each lonely corner is on the positive side of the other
///            /\                      triangle, turning that one round if need be, the order of the
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

/// How a pair meets: crossing, or in a way that the triangles next to it decide.
enum class Meeting { none, crossing, edge_of_a_in_b, edge_of_b_in_a, edge_on_edge };

/// The edge of a that lies in b's plane, by the corner opposite to it.
int corner_off_plane(const Sides& sides) { return sides.of[0] != 0 ? 0 : sides.of[1] != 0 ? 1 : 2; }

/// Does a's edge, which lies in b's plane, run through b's inside? b has corners on both sides of the edge's
/// line, so only a side of b can part them. Sides are told in space, by planes through a's corner off the
/// plane.
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

/// Do two edges in one line share more than a point?
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

// ---- Meetings that the triangles next to them decide ----

struct EdgeId {
  int surface, low, high;  // vertices, low < high

  auto operator<=>(const EdgeId&) const = default;
};

/// An edge of one surface runs through the inside of a triangle of the other; `side` of that triangle's plane
/// is where a triangle at the edge lies.
struct EdgeInTriangle {
  EdgeId edge;
  TriangleId crossed;
  int side;
  Crossing pair;

  auto operator<=>(const EdgeInTriangle&) const = default;
};

/// Edges of two surfaces lie on each other; `pair` are triangles at them, and these are their third corners.
struct EdgeOnEdge {
  EdgeId first, second;
  int wing_first, wing_second;
  Crossing pair;

  auto operator<=>(const EdgeOnEdge&) const = default;
};

/// Calls judge(begin, end) for each run of equal keys in a sorted list.
template <class Item, class Key, class Judge>
void for_each_group(const std::vector<Item>& items, Key key, Judge judge) {
  for (auto begin = items.begin(); begin != items.end();) {
    const auto end =
        std::find_if(begin, items.end(), [&](const Item& item) { return key(item) != key(*begin); });
    judge(begin, end);
    begin = end;
  }
}

/// Directions around an axis, seen along it.
struct Around {
  const Vec3 &from, &to;  // the axis

  /// Positive if a turn of less than half leads from p to q.
  int turn(const Vec3& p, const Vec3& q) const { return orient3d(from, to, p, q); }

  /// Strictly between `first` and `last` on the way round in the positive sense.
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

/// Pairs of triangles whose boxes overlap: a sweep along one axis in each of many strips along a second.
/// Boxes are kept in floats: rounding never changes the order of two numbers, so it hides no overlap.
class Sweep {
 public:
  explicit Sweep(std::span<const SurfaceView> surfaces) {
    for (std::size_t s = 0; s < surfaces.size(); ++s) add(static_cast<int>(s), surfaces[s]);
    choose_axes();
    std::sort(boxes_.begin(), boxes_.end(), [this](const Box& p, const Box& q) {
      return std::pair(p.low[sweep_axis_], p.id) < std::pair(q.low[sweep_axis_], q.id);
    });
    fill_strips();
  }

  /// Calls visit(p, q) once for every two triangles whose boxes overlap.
  template <class Visit>
  void for_each_pair(Visit visit) const {
    std::vector<int> hits(boxes_.size());
    for (int s = 0; s < static_cast<int>(strips_.size()); ++s) {
      const Strip& strip = strips_[s];
      for (std::size_t i = 0; i < strip.boxes.size(); ++i) {
        const int num_hits = strip.collect_overlaps(i, hits.data());
        const Box& box = boxes_[strip.boxes[i]];
        for (int h = 0; h < num_hits; ++h) {
          const Box& other = boxes_[strip.boxes[hits[h]]];
          const bool is_first_in_common = std::max(box.first_strip, other.first_strip) == s;
          if (is_first_in_common) visit(box.id, other.id);
        }
      }
    }
  }

 private:
  static constexpr int kMostStrips = 1024;
  static constexpr float kBoxesPerStrip = 3;  // width of a strip, in mean widths of boxes

  struct Box {
    std::array<float, 3> low, high;
    TriangleId id;
    int first_strip = 0;
  };

  /// The boxes that reach into a strip in the order of the sweep, as columns.
  struct Strip {
    std::vector<int> boxes;
    std::vector<float> start, end, low_y, high_y, low_z, high_z;

    /// Places of boxes after place i that overlap box i; how many.
    int collect_overlaps(std::size_t i, int* hits) const {
      const int num_boxes = static_cast<int>(boxes.size());
      const float to = end[i], ly = low_y[i], hy = high_y[i], lz = low_z[i], hz = high_z[i];
      int count = 0;
      for (int j = static_cast<int>(i) + 1; j < num_boxes && start[j] <= to; ++j) {
        hits[count] = j;
        count += int{low_y[j] <= hy} & int{high_y[j] >= ly} & int{low_z[j] <= hz} & int{high_z[j] >= lz};
      }
      return count;
    }
  };

  void add(int surface, const SurfaceView& view) {
    for (std::size_t t = 0; t < view.triangles.size(); ++t) {
      const auto& [a, b, c] = view.triangles[t];
      const Vec3 &x = view.positions[a], &y = view.positions[b], &z = view.positions[c];
      const Eigen::Vector3f low = x.cwiseMin(y).cwiseMin(z).cast<float>();
      const Eigen::Vector3f high = x.cwiseMax(y).cwiseMax(z).cast<float>();
      boxes_.push_back(
          {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}, {surface, static_cast<int>(t)}});
    }
  }

  /// The sweep goes where the boxes vary most, the strips lie where they vary second most.
  void choose_axes() {
    Vec3 sum = Vec3::Zero(), sum_sq = Vec3::Zero();
    for (const Box& box : boxes_) {
      const Vec3 low(box.low[0], box.low[1], box.low[2]);
      sum += low;
      sum_sq += low.cwiseAbs2();
    }
    const double count = std::max<double>(1, static_cast<double>(boxes_.size()));
    const Vec3 variance = sum_sq / count - (sum / count).cwiseAbs2();
    std::array<int, 3> axes = {0, 1, 2};
    std::sort(axes.begin(), axes.end(), [&](int i, int j) { return variance[i] > variance[j]; });
    std::tie(sweep_axis_, strip_axis_, third_axis_) = std::tie(axes[0], axes[1], axes[2]);
  }

  void fill_strips() {
    float low = std::numeric_limits<float>::max(), high = -low;
    double widths = 0;
    for (const Box& box : boxes_) {
      low = std::min(low, box.low[strip_axis_]);
      high = std::max(high, box.high[strip_axis_]);
      widths += box.high[strip_axis_] - box.low[strip_axis_];
    }
    const double width = kBoxesPerStrip * widths / std::max<double>(1, static_cast<double>(boxes_.size()));
    const double wanted = width > 0 ? (static_cast<double>(high) - low) / width : 1;
    strips_.resize(static_cast<std::size_t>(std::clamp(wanted, 1.0, double{kMostStrips})));
    const auto strip_at = [&](float x) {
      const double place =
          high > low ? (static_cast<double>(x) - low) / (static_cast<double>(high) - low) : 0;
      return std::min(static_cast<int>(place * static_cast<double>(strips_.size())),
                      static_cast<int>(strips_.size()) - 1);
    };
    for (int k = 0; k < static_cast<int>(boxes_.size()); ++k) {
      Box& box = boxes_[k];
      box.first_strip = strip_at(box.low[strip_axis_]);
      const int last = strip_at(box.high[strip_axis_]);
      for (int s = box.first_strip; s <= last; ++s) add_to_strip(k, strips_[s]);
    }
  }

  void add_to_strip(int k, Strip& strip) const {
    const Box& box = boxes_[k];
    strip.boxes.push_back(k);
    strip.start.push_back(box.low[sweep_axis_]);
    strip.end.push_back(box.high[sweep_axis_]);
    strip.low_y.push_back(box.low[strip_axis_]);
    strip.high_y.push_back(box.high[strip_axis_]);
    strip.low_z.push_back(box.low[third_axis_]);
    strip.high_z.push_back(box.high[third_axis_]);
  }

  std::vector<Box> boxes_;  // in the order of the sweep
  int sweep_axis_ = 0, strip_axis_ = 1, third_axis_ = 2;
  std::vector<Strip> strips_;
};

class Finder {
 public:
  explicit Finder(std::span<const SurfaceView> surfaces) : surfaces_(surfaces) {}

  std::vector<Crossing> find() {
    Sweep(surfaces_).for_each_pair([this](TriangleId p, TriangleId q) { judge(p, q); });
    judge_edges_in_triangles();
    judge_edges_on_edges();
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

  void judge(TriangleId a, TriangleId b) {
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

  /// The second way: one edge, one triangle, and wings on both of its sides.
  void judge_edges_in_triangles() {
    std::sort(in_triangles_.begin(), in_triangles_.end());
    const auto key = [](const EdgeInTriangle& item) { return std::pair(item.edge, item.crossed); };
    for_each_group(in_triangles_, key, [this](auto begin, auto end) {
      if (begin->side != std::prev(end)->side) crossings_.push_back(first_pair(begin, end));
    });
  }

  /// The third way: two edges, and wings that alternate around them.
  void judge_edges_on_edges() {
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

}  // namespace weft::verify
