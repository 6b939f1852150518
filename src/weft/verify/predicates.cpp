#include "weft/verify/predicates.h"

#include <array>
#include <cmath>

#include "weft/verify/expansion.h"

namespace weft::engine::verify {
namespace {

constexpr double kHalfUlp = 0x1p-53;  // largest relative rounding error of one operation
constexpr double kBound2d = (3 + 16 * kHalfUlp) * kHalfUlp;  // of orient2d's determinant, times its permanent
constexpr double kBound3d = (7 + 56 * kHalfUlp) * kHalfUlp;  // of orient3d's

/// An expansion of up to N terms.
template <int N>
struct Expansion {
  std::array<double, N> terms;
  int size = 0;

  void add(double b) { size = grow_expansion(terms.data(), size, b); }
  int sign_of_sum() const { return size == 0 ? 0 : sign(terms[size - 1]); }
};

Expansion<2> difference(double a, double b) {
  const auto [high, low] = two_sum(a, -b);
  Expansion<2> result;
  result.add(low);
  result.add(high);
  return result;
}

template <int N, int M>
Expansion<2 * N * M> operator*(const Expansion<N>& a, const Expansion<M>& b) {
  Expansion<2 * N * M> result;
  for (int i = 0; i < a.size; ++i) {
    for (int j = 0; j < b.size; ++j) {
      const auto [high, low] = two_product(a.terms[i], b.terms[j]);
      result.add(low);
      result.add(high);
    }
  }
  return result;
}

template <int N, int M>
Expansion<N + M> combine(const Expansion<N>& a, const Expansion<M>& b, double factor) {
  Expansion<N + M> result;
  for (int i = 0; i < a.size; ++i) result.terms[i] = a.terms[i];
  result.size = a.size;
  for (int j = 0; j < b.size; ++j) result.add(factor * b.terms[j]);
  return result;
}

template <int N, int M>
Expansion<N + M> operator+(const Expansion<N>& a, const Expansion<M>& b) {
  return combine(a, b, 1);
}

template <int N, int M>
Expansion<N + M> operator-(const Expansion<N>& a, const Expansion<M>& b) {
  return combine(a, b, -1);
}

int orient3d_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto ax = difference(a.x(), d.x()), ay = difference(a.y(), d.y()), az = difference(a.z(), d.z());
  const auto bx = difference(b.x(), d.x()), by = difference(b.y(), d.y()), bz = difference(b.z(), d.z());
  const auto cx = difference(c.x(), d.x()), cy = difference(c.y(), d.y()), cz = difference(c.z(), d.z());
  const auto det = (bx * cy - cx * by) * az + (cx * ay - ax * cy) * bz + (ax * by - bx * ay) * cz;
  return det.sign_of_sum();
}

int orient2d_exact(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const auto det = difference(a.x(), c.x()) * difference(b.y(), c.y()) -
                   difference(a.y(), c.y()) * difference(b.x(), c.x());
  return det.sign_of_sum();
}

}  // namespace

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const double ax = a.x() - d.x(), ay = a.y() - d.y(), az = a.z() - d.z();
  const double bx = b.x() - d.x(), by = b.y() - d.y(), bz = b.z() - d.z();
  const double cx = c.x() - d.x(), cy = c.y() - d.y(), cz = c.z() - d.z();
  const double bxcy = bx * cy, cxby = cx * by, cxay = cx * ay, axcy = ax * cy, axby = ax * by, bxay = bx * ay;
  const double det = az * (bxcy - cxby) + bz * (cxay - axcy) + cz * (axby - bxay);
  const double permanent = std::abs(az) * (std::abs(bxcy) + std::abs(cxby)) +
                           std::abs(bz) * (std::abs(cxay) + std::abs(axcy)) +
                           std::abs(cz) * (std::abs(axby) + std::abs(bxay));
  if (std::abs(det) > kBound3d * permanent) return sign(det);
  return permanent == 0 ? 0 : orient3d_exact(a, b, c, d);  // products of nonzeros do not vanish in this range
}

int orient2d(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const double left = (a.x() - c.x()) * (b.y() - c.y()), right = (a.y() - c.y()) * (b.x() - c.x());
  const double det = left - right, permanent = std::abs(left) + std::abs(right);
  if (std::abs(det) > kBound2d * permanent) return sign(det);
  return permanent == 0 ? 0 : orient2d_exact(a, b, c);
}

}  // namespace weft::engine::verify
