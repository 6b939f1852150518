#include "weft/forces/hinge.h"

#include <algorithm>

#include "weft/core/angle.h"

namespace weft::engine {
namespace {

constexpr double kPi = 3.141592653589793;
constexpr double kMinHeight = 1e-3;  // minimum triangle height over edge length, for the gradient [1]

/// Normals with a length of twice their triangle's area.
struct Normals {
  Vec3 edge, n0, n1;
};

Normals normals(const HingeCorners& x) {
  const Vec3 e = x[1] - x[0];
  return {e, e.cross(x[2] - x[0]), (x[3] - x[0]).cross(e)};
}

double short_way_round(double angle) {
  if (angle > kPi) return angle - 2 * kPi;
  return angle <= -kPi ? angle + 2 * kPi : angle;
}

/// ∂θ/∂x of the corner opposite to the edge: the unit normal over the triangle's height.
Vec3 tip_gradient(const Vec3& normal, double edge_length) {
  const double twice_area = normal.norm();
  if (twice_area == 0 || edge_length == 0) return Vec3::Zero();
  const double height = std::max(twice_area / edge_length, kMinHeight * edge_length);
  return normal / (twice_area * height);
}

}  // namespace

double hinge_stiffness(double rigidity, const HingeCorners& rest) {
  const Normals n = normals(rest);
  return rigidity * n.edge.squaredNorm() / (0.5 * (n.n0.norm() + n.n1.norm()));
}

double hinge_angle(const HingeCorners& x) {
  const Normals n = normals(x);
  const double length = n.edge.norm();
  if (length == 0) return 0;
  const double sine = n.n1.cross(n.n0).dot(n.edge) / length;
  return find_angle(sine, n.n0.dot(n.n1));
}

HingeCorners hinge_angle_gradient(const HingeCorners& x) {
  const Normals n = normals(x);
  const double length = n.edge.norm();
  HingeCorners gradient = {Vec3::Zero(), Vec3::Zero(), tip_gradient(n.n0, length),
                           tip_gradient(n.n1, length)};
  if (length == 0) return gradient;
  // Lever rule: the edge's ends balance each tip by its projection on the edge.
  const double inv_length_sq = 1 / n.edge.squaredNorm();
  for (const int tip : {2, 3}) {
    const double along = (x[tip] - x[0]).dot(n.edge) * inv_length_sq;
    gradient[0] -= (1 - along) * gradient[tip];
    gradient[1] -= along * gradient[tip];
  }
  return gradient;
}

double hinge_energy(double stiffness, double rest_angle, const HingeCorners& x) {
  const double bend = short_way_round(hinge_angle(x) - rest_angle);
  return 0.5 * stiffness * bend * bend;
}

HingeCorners hinge_force(double stiffness, double rest_angle, const HingeCorners& x) {
  const double moment = stiffness * short_way_round(hinge_angle(x) - rest_angle);
  HingeCorners force = hinge_angle_gradient(x);
  for (Vec3& f : force) f *= -moment;
  return force;
}

std::array<double, 4> hinge_rest_weights(const HingeCorners& rest) {
  const Vec3 normal = normals(rest).n0.normalized();
  const HingeCorners gradient = hinge_angle_gradient(rest);
  std::array<double, 4> weights;
  for (int c = 0; c < 4; ++c) weights[c] = gradient[c].norm() * (gradient[c].dot(normal) < 0 ? -1.0 : 1.0);
  return weights;
}

Mat3 hinge_gauss_newton_block(double stiffness, const HingeCorners& gradient, int a, int b) {
  return stiffness * gradient[a] * gradient[b].transpose();
}

}  // namespace weft::engine
