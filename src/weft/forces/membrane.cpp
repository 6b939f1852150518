#include "weft/forces/membrane.h"

#include <cmath>

namespace weft::engine {
namespace {

/// Columns of F: images of the warp and weft directions.
struct Deformation {
  Vec3 warp, weft;
};

Deformation deformation(const RestTriangle& rest, const TriangleCorners& x) {
  // Differences, so that the result does not depend on the triangle's position.
  const Vec3 d1 = x[1] - x[0], d2 = x[2] - x[0];
  return {rest.gradient[1].x() * d1 + rest.gradient[2].x() * d2,
          rest.gradient[1].y() * d1 + rest.gradient[2].y() * d2};
}

Vec3 green_strain(const Deformation& f) {
  return {0.5 * (f.warp.squaredNorm() - 1), 0.5 * (f.weft.squaredNorm() - 1), f.warp.dot(f.weft)};
}

/// ∂e/∂x_c for a corner of gradient g: rows ε11, ε22, 2 ε12.
Mat3 strain_derivative(const Deformation& f, const Vec2& g) {
  Mat3 b;
  b.row(0) = g.x() * f.warp.transpose();
  b.row(1) = g.y() * f.weft.transpose();
  b.row(2) = g.y() * f.warp.transpose() + g.x() * f.weft.transpose();
  return b;
}

}  // namespace

Vec3 membrane_strain(const RestTriangle& rest, const TriangleCorners& x) {
  return green_strain(deformation(rest, x));
}

std::array<Mat3, 3> membrane_strain_derivative(const RestTriangle& rest, const TriangleCorners& x) {
  const Deformation f = deformation(rest, x);
  return {strain_derivative(f, rest.gradient[0]), strain_derivative(f, rest.gradient[1]),
          strain_derivative(f, rest.gradient[2])};
}

std::array<double, 2> principal_stretches(const RestTriangle& rest, const TriangleCorners& x) {
  // Square roots of the eigenvalues of FᵀF, the smaller one from the determinant |warp × weft|².
  const Deformation f = deformation(rest, x);
  const double a = f.warp.squaredNorm(), b = f.weft.squaredNorm(), c = f.warp.dot(f.weft);
  const double largest = std::sqrt(0.5 * (a + b) + std::sqrt(0.25 * (a - b) * (a - b) + c * c));
  return {largest > 0 ? f.warp.cross(f.weft).norm() / largest : 0.0, largest};
}

TriangleCorners stress_force(const RestTriangle& rest, const Vec3& s, const TriangleCorners& x) {
  const Deformation f = deformation(rest, x);
  const Vec3 pull_warp = rest.area * (s[0] * f.warp + s[2] * f.weft);
  const Vec3 pull_weft = rest.area * (s[2] * f.warp + s[1] * f.weft);
  TriangleCorners force;
  for (int c = 1; c < 3; ++c) {
    force[c] = -(rest.gradient[c].x() * pull_warp + rest.gradient[c].y() * pull_weft);
  }
  force[0] = -force[1] - force[2];
  return force;
}

std::array<double, 3> stress_weights(const RestTriangle& rest, const Vec3& s) {
  Eigen::Matrix2d tension;
  tension << s[0], s[2], s[2], s[1];
  std::array<double, 3> weights;
  for (int a = 0; a < 3; ++a) {
    const Vec2 &g1 = rest.gradient[(a + 1) % 3], &g2 = rest.gradient[(a + 2) % 3];
    weights[a] = -rest.area * g1.dot(tension * g2);
  }
  return weights;
}

double stress_block(const std::array<double, 3>& weights, int a, int b, StressFilter filter) {
  const auto weight = [&](int opposite) {
    return filter == StressFilter::absolute ? std::abs(weights[opposite]) : weights[opposite];
  };
  return a == b ? weight((a + 1) % 3) + weight((a + 2) % 3) : -weight(3 - a - b);
}

}  // namespace weft::engine
