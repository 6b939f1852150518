#include "weft/verify/pair_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "weft/verify/expansion.h"
#include "weft/verify/predicates.h"

namespace weft::engine::verify {
namespace {

/// Perturbation of the vertex or first edge against ties [m].
const Vec3 kAside(0x1.3a5p-150, 0x1.71bp-151, 0x1.d17p-152);
constexpr double kFarFromAside = 1e-40;  // [m]
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Relative rounding errors, times the sum of a determinant's products in magnitude: Shewchuk's, doubled.
constexpr double kBound2d = 6 * 0x1p-53, kBound3d = 14 * 0x1p-53;

/// An exact number.
class Exact {
 public:
  void add(double b) {
    terms_.push_back(0);
    terms_.resize(grow_expansion(terms_.data(), static_cast<int>(terms_.size()) - 1, b));
  }

  int sign_of_sum() const { return terms_.empty() ? 0 : sign(terms_.back()); }

  friend Exact operator*(const Exact& a, const Exact& b) {
    Exact result;
    for (const double s : a.terms_) {
      for (const double t : b.terms_) {
        const auto [high, low] = two_product(s, t);
        result.add(low);
        result.add(high);
      }
    }
    return result;
  }

  friend Exact operator+(Exact a, const Exact& b) {
    for (const double t : b.terms_) a.add(t);
    return a;
  }

  friend Exact operator-(Exact a, const Exact& b) {
    for (const double t : b.terms_) a.add(-t);
    return a;
  }

 private:
  std::vector<double> terms_;
};

/// A determinant in doubles, and the bound of its error.
struct Estimate {
  double value, error;

  bool is_decided() const { return std::abs(value) > error; }
};

/// A corner of f's image: `to` − `from` − kAside.
struct Corner {
  const Vec3 *from, *to;
  Vec3 value;  // to − from, rounded

  Exact exact(int axis) const {
    Exact result;
    result.add((*to)[axis]);
    result.add(-(*from)[axis]);
    result.add(-kAside[axis]);
    return result;
  }
};

/// The sign of the two corners' cross product, seen along x.
int turn(const Corner& a, const Corner& b) {
  const Vec3 &p = a.value, &q = b.value;
  const double left = p.y() * q.z(), right = p.z() * q.y();
  const double size = std::max(p.cwiseAbs().maxCoeff(), q.cwiseAbs().maxCoeff());
  const Estimate estimate{
      left - right, kBound2d * (std::abs(left) + std::abs(right)) + 8 * kAside.x() * (size + kAside.x())};
  if (estimate.is_decided()) return sign(estimate.value);
  return (a.exact(1) * b.exact(2) - a.exact(2) * b.exact(1)).sign_of_sum();
}

/// a · (b × c).
Estimate estimate_volume(const Corner& a, const Corner& b, const Corner& c) {
  const Vec3 &p = a.value, &q = b.value, &r = c.value;
  const auto minor = [&](int i, int j) { return q[i] * r[j] - q[j] * r[i]; };
  const auto bound = [&](int i, int j) { return std::abs(q[i] * r[j]) + std::abs(q[j] * r[i]); };
  const double value = p.x() * minor(1, 2) + p.y() * minor(2, 0) + p.z() * minor(0, 1);
  const double permanent =
      std::abs(p.x()) * bound(1, 2) + std::abs(p.y()) * bound(2, 0) + std::abs(p.z()) * bound(0, 1);
  const double size =
      std::max({p.cwiseAbs().maxCoeff(), q.cwiseAbs().maxCoeff(), r.cwiseAbs().maxCoeff()}) + kAside.x();
  return {value, kBound3d * permanent + 32 * kAside.x() * size * size};
}

Exact compute_volume(const Corner& a, const Corner& b, const Corner& c) {
  const auto minor = [&](int i, int j) { return b.exact(i) * c.exact(j) - b.exact(j) * c.exact(i); };
  return a.exact(0) * minor(1, 2) + a.exact(1) * minor(2, 0) + a.exact(2) * minor(0, 1);
}

int volume_sign(const Corner& a, const Corner& b, const Corner& c) {
  const Estimate estimate = estimate_volume(a, b, c);
  return estimate.is_decided() ? sign(estimate.value) : compute_volume(a, b, c).sign_of_sum();
}

using Quad = std::array<int, 4>;

/// f's image of the boundary of a prism or a cube, given by its corners. The positions must outlive it.
class Image {
 public:
  void add(const Vec3& from, const Vec3& to) { corners_[size_++] = {&from, &to, to - from}; }

  /// True only if a plane perpendicular to an axis, or to the direction of the corners' centre, separates the
  /// corners from the origin: then f has no root.
  bool is_aside() {
    Vec3 low = Vec3::Constant(kInfinity), high = -low, middle = Vec3::Zero();
    for (int k = 0; k < size_; ++k) {
      low = low.cwiseMin(corners_[k].value);
      high = high.cwiseMax(corners_[k].value);
      middle += corners_[k].value;
    }
    if (low.maxCoeff() > kFarFromAside || high.minCoeff() < -kFarFromAside) return true;
    reach_ = std::max(-low.minCoeff(), high.maxCoeff());  // the box contains the origin
    return is_aside_along(middle);
  }

  /// The same for a plane perpendicular to the direction; call after is_aside().
  bool is_aside_along(const Vec3& direction) const {
    double low = kInfinity, high = -kInfinity;
    for (int k = 0; k < size_; ++k) {
      const double at = direction.dot(corners_[k].value);
      low = std::min(low, at);
      high = std::max(high, at);
    }
    const double margin = 1e-12 * reach_ * direction.cwiseAbs().sum() + kFarFromAside;
    return low > margin || high < -margin;
  }

  /// Whether the ray from the origin along x meets the triangle.
  bool is_ahead(int a, int b, int c) const {
    const int turns = turns_of(a, b) + turns_of(b, c) + turns_of(c, a);
    return turns != 0 && turns * volume_sign(corners_[a], corners_[b], corners_[c]) > 0;
  }

  /// Whether it meets exactly one of the quad's two triangles that share its first and third corner.
  bool meets_triangles(const Quad& q) const {
    return is_ahead(q[0], q[1], q[2]) != is_ahead(q[0], q[2], q[3]);
  }

  /// Whether the origin is between those triangles and the bilinear patch through the quad's sides. On the
  /// patch the products of barycentric coordinates of opposite corners are equal.
  bool is_under_patch(const Quad& q) const {
    const Corner *a = &corners_[q[0]], *b = &corners_[q[1]], *c = &corners_[q[2]], *d = &corners_[q[3]];
    const std::array<std::array<const Corner*, 3>, 4> faces = {{{b, c, d}, {a, d, c}, {a, b, d}, {a, c, b}}};
    int side = 0;
    for (const auto& [p, q1, r] : faces) {
      const int own = volume_sign(*p, *q1, *r);
      if (own == 0 || own == -side) return false;
      side = own;
    }
    std::array<Estimate, 4> volumes;
    for (int k = 0; k < 4; ++k) volumes[k] = estimate_volume(*faces[k][0], *faces[k][1], *faces[k][2]);
    const Estimate estimate = difference_of_products(volumes);
    if (estimate.is_decided()) return estimate.value > 0;
    const auto exact = [&](int k) { return compute_volume(*faces[k][0], *faces[k][1], *faces[k][2]); };
    return (exact(0) * exact(2) - exact(1) * exact(3)).sign_of_sum() > 0;
  }

 private:
  bool is_below(int a) const { return corners_[a].value.y() <= kAside.y(); }

  /// Viewed along x, sides that go up left of the origin add one, those that go down subtract one.
  int turns_of(int a, int b) const {
    if (is_below(a) == is_below(b)) return 0;
    const int side = turn(corners_[a], corners_[b]);
    return is_below(a) ? (side > 0 ? 1 : 0) : (side < 0 ? -1 : 0);
  }

  static Estimate difference_of_products(const std::array<Estimate, 4>& v) {
    const double left = v[0].value * v[2].value, right = v[1].value * v[3].value;
    const auto error = [&](int i, int j) {
      return (std::abs(v[i].value) + v[i].error) * v[j].error + std::abs(v[j].value) * v[i].error;
    };
    return {left - right, 2 * (error(0, 2) + error(1, 3)) + 4 * 0x1p-53 * (std::abs(left) + std::abs(right))};
  }

  std::array<Corner, 8> corners_;
  int size_ = 0;
  double reach_ = 0;  // of the corners, along any axis [m]
};

// ---- Exactly touching ----

Eigen::Vector2d seen_along(int axis, const Vec3& p) { return {p[(axis + 1) % 3], p[(axis + 2) % 3]}; }

/// Whether a point in the triangle's plane is inside it.
bool is_in_triangle(const Vec3& p, const std::array<Vec3, 3>& triangle) {
  for (int axis = 0; axis < 3; ++axis) {
    bool is_left = false, is_right = false;
    for (int k = 0; k < 3; ++k) {
      const int side = orient2d(seen_along(axis, triangle[k]), seen_along(axis, triangle[(k + 1) % 3]),
                                seen_along(axis, p));
      is_left |= side > 0;
      is_right |= side < 0;
    }
    if (is_left && is_right) return false;
  }
  return true;
}

bool touches(const Vec3& p, const std::array<Vec3, 3>& t) {
  return orient3d(t[0], t[1], t[2], p) == 0 && is_in_triangle(p, t);
}

bool touch(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b) {
  if (orient3d(a[0], a[1], b[0], b[1]) != 0) return false;
  const auto are_apart = [](const std::array<Vec3, 2>& line, const std::array<Vec3, 2>& other, int axis) {
    const auto side = [&](const Vec3& p) {
      return orient2d(seen_along(axis, line[0]), seen_along(axis, line[1]), seen_along(axis, p));
    };
    return side(other[0]) * side(other[1]) > 0;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const auto [a_low, a_high] = std::minmax(a[0][axis], a[1][axis]);
    const auto [b_low, b_high] = std::minmax(b[0][axis], b[1][axis]);
    if (a_high < b_low || b_high < a_low || are_apart(a, b, axis) || are_apart(b, a, axis)) return false;
  }
  return true;
}

std::array<Vec3, 3> starts_of(const std::array<PointMotion, 3>& t) {
  return {t[0].start, t[1].start, t[2].start};
}
std::array<Vec3, 3> ends_of(const std::array<PointMotion, 3>& t) { return {t[0].end, t[1].end, t[2].end}; }
std::array<Vec3, 2> starts_of(const std::array<PointMotion, 2>& e) { return {e[0].start, e[1].start}; }
std::array<Vec3, 2> ends_of(const std::array<PointMotion, 2>& e) { return {e[0].end, e[1].end}; }

}  // namespace

PairMotion test_vertex_triangle(const PointMotion& vertex, const std::array<PointMotion, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  Image image;
  for (const PointMotion& corner : triangle) image.add(vertex.start, corner.start);
  for (const PointMotion& corner : triangle) image.add(vertex.end, corner.end);
  if (image.is_aside()) return {};
  const Vec3 normal = (b.start - a.start).cross(c.start - a.start) + (b.end - a.end).cross(c.end - a.end);
  if (image.is_aside_along(normal)) return {};
  for (int k = 0; k < 3; ++k) {
    const PointMotion &p = triangle[k], &q = triangle[(k + 1) % 3];
    if (image.is_aside_along(normal.cross(q.start - p.start + q.end - p.end))) return {};
  }

  bool is_odd = image.is_ahead(0, 1, 2) != image.is_ahead(3, 4, 5);
  for (const Quad& side : {Quad{0, 1, 4, 3}, Quad{1, 2, 5, 4}, Quad{2, 0, 3, 5}}) {
    is_odd ^= image.meets_triangles(side);
    is_odd ^= image.is_under_patch(side);
  }
  return {is_odd, touches(vertex.start, starts_of(triangle)), touches(vertex.end, ends_of(triangle))};
}

PairMotion test_edge_edge(const std::array<PointMotion, 2>& first, const std::array<PointMotion, 2>& second) {
  const auto& [a, b] = first;
  const auto& [c, d] = second;
  Image image;  // corner 4 · (at the end) + 2 · (end of the second edge) + (end of the first)
  for (const PointMotion& to : second) {
    for (const PointMotion& from : first) image.add(from.start, to.start);
  }
  for (const PointMotion& to : second) {
    for (const PointMotion& from : first) image.add(from.end, to.end);
  }
  if (image.is_aside()) return {};
  const Vec3 normal = (b.start - a.start).cross(d.start - c.start) + (b.end - a.end).cross(d.end - c.end);
  if (image.is_aside_along(normal) || image.is_aside_along(normal.cross(b.start - a.start + b.end - a.end)) ||
      image.is_aside_along(normal.cross(d.start - c.start + d.end - c.end)))
    return {};

  bool is_odd = image.meets_triangles({0, 1, 3, 2}) != image.meets_triangles({4, 5, 7, 6});  // both plane
  for (const Quad& side : {Quad{0, 1, 5, 4}, Quad{2, 3, 7, 6}, Quad{0, 2, 6, 4}, Quad{1, 3, 7, 5}}) {
    is_odd ^= image.meets_triangles(side);
    is_odd ^= image.is_under_patch(side);
  }
  return {is_odd, touch(starts_of(first), starts_of(second)), touch(ends_of(first), ends_of(second))};
}

}  // namespace weft::engine::verify
