#include "weft/forces/collapse.h"

#include <cmath>

namespace weft::engine {
namespace {

constexpr double kNoLength = 1e-12;  // stretch below which the direction is undefined [1]
constexpr double kHalfRoot = 0.70710678118654752;

using Columns = std::array<Vec3, 2>;  // a 3×2 matrix

/// F = Σ σ_i u_i v_iᵀ, σ1 >= σ2.
struct PrincipalAxes {
  std::array<double, 2> stretch;
  Columns in_space;             // u, orthonormal
  std::array<Vec2, 2> at_rest;  // v, orthonormal
};

/// A unit vector perpendicular to u.
Vec3 any_across(const Vec3& u) {
  int least = 0;
  u.cwiseAbs().minCoeff(&least);
  return u.cross(Vec3::Unit(least)).normalized();
}

/// The eigenvector of [a c; c b] with the larger eigenvalue.
Vec2 larger_axis(double a, double b, double c) {
  const double half = (a - b) / 2, radius = std::sqrt(half * half + c * c);
  if (radius == 0) return Vec2::UnitX();
  const double larger = std::sqrt((1 + std::abs(half) / radius) / 2), smaller = c / (2 * radius * larger);
  return half >= 0 ? Vec2(larger, smaller) : Vec2(std::abs(smaller), std::copysign(larger, c));
}

Columns deformation(const RestTriangle& rest, const TriangleCorners& x) {
  const Vec3 d1 = x[1] - x[0], d2 = x[2] - x[0];
  return {rest.gradient[1].x() * d1 + rest.gradient[2].x() * d2,
          rest.gradient[1].y() * d1 + rest.gradient[2].y() * d2};
}

/// σ2 >= kCollapseBegin: FᵀF − kCollapseBegin² I is positive definite.
bool is_wide(const Columns& f) {
  constexpr double kCollapseBeginSq = kCollapseBegin * kCollapseBegin;
  const double a = f[0].squaredNorm() - kCollapseBeginSq, b = f[1].squaredNorm() - kCollapseBeginSq,
               c = f[0].dot(f[1]);
  return a > 0 && a * b > c * c;
}

PrincipalAxes principal_axes(const Columns& f) {
  PrincipalAxes axes;
  const Vec2 v = larger_axis(f[0].squaredNorm(), f[1].squaredNorm(), f[0].dot(f[1]));
  axes.at_rest = {v, Vec2(-v.y(), v.x())};
  const Vec3 along = v.x() * f[0] + v.y() * f[1], across = v.x() * f[1] - v.y() * f[0];
  axes.stretch = {along.norm(), across.norm()};
  axes.in_space[0] = axes.stretch[0] > kNoLength ? Vec3(along / axes.stretch[0]) : Vec3(Vec3::UnitX());
  const Vec3 normal = across - across.dot(axes.in_space[0]) * axes.in_space[0];
  axes.in_space[1] = normal.norm() > kNoLength ? Vec3(normal.normalized()) : any_across(axes.in_space[0]);
  return axes;
}

/// ψ, −ψ' and ψ''.
LimitResponse respond(const StrainLimit& law, double stretch) { return limit_response(law, 1 - stretch); }

/// (a v1ᵀ + b v2ᵀ) g_c for each corner.
TriangleCorners corners_of(const RestTriangle& rest, const PrincipalAxes& axes, const Vec3& a,
                           const Vec3& b) {
  TriangleCorners corners;
  for (int c = 0; c < 3; ++c)
    corners[c] = axes.at_rest[0].dot(rest.gradient[c]) * a + axes.at_rest[1].dot(rest.gradient[c]) * b;
  return corners;
}

}  // namespace

StrainLimit make_collapse_law(const ClothModel& model) {
  double sum = 0;
  int count = 0;
  const std::vector<Spring>& springs = model.topology->springs;
  for (std::size_t s = 0; s < springs.size(); ++s) {
    if (springs[s].kind != SpringKind::structural) continue;
    sum += model.stiffness(static_cast<int>(s));
    ++count;
  }
  double stiffness = count > 0 ? sum / count : 0.0;
  if (model.elements && !model.elements->membranes.empty())
    stiffness += (model.elements->stiffness(0, 0) + model.elements->stiffness(1, 1)) / 2;
  return {1 - kCollapseBegin, 1 - kCollapseFull, stiffness};
}

double collapse_energy(const RestTriangle& rest, const StrainLimit& law, const TriangleCorners& x) {
  const Columns f = deformation(rest, x);
  if (is_wide(f)) return 0;
  const PrincipalAxes axes = principal_axes(f);
  return rest.area * (respond(law, axes.stretch[0]).energy + respond(law, axes.stretch[1]).energy);
}

TriangleCorners collapse_force(const RestTriangle& rest, const StrainLimit& law, const TriangleCorners& x) {
  const Columns f = deformation(rest, x);
  if (is_wide(f)) return {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  const PrincipalAxes axes = principal_axes(f);
  const auto push = [&](int i) -> Vec3 {
    return rest.area * respond(law, axes.stretch[i]).tension * axes.in_space[i];
  };
  return corners_of(rest, axes, push(0), push(1));
}

std::array<CollapseAxis, 2> collapse_axes(const RestTriangle& rest, const StrainLimit& law,
                                          const TriangleCorners& x) {
  const Columns f = deformation(rest, x);
  if (is_wide(f)) return {};
  const PrincipalAxes axes = principal_axes(f);
  const Vec3 none = Vec3::Zero();
  return {CollapseAxis{respond(law, axes.stretch[0]), corners_of(rest, axes, -axes.in_space[0], none)},
          CollapseAxis{respond(law, axes.stretch[1]), corners_of(rest, axes, none, -axes.in_space[1])}};
}

CollapseHessian collapse_hessian(const RestTriangle& rest, const StrainLimit& law, const TriangleCorners& x,
                                 HessianKind kind) {
  const Columns f = deformation(rest, x);
  if (is_wide(f)) return {};
  const PrincipalAxes axes = principal_axes(f);
  const auto [s1, s2] = axes.stretch;
  const auto& [u1, u2] = axes.in_space;
  const LimitResponse r1 = respond(law, s1), r2 = respond(law, s2);
  CollapseHessian hessian;
  const auto add = [&](double stiffness, const Vec3& a, const Vec3& b) {
    if (stiffness == 0 || (kind == HessianKind::positive && stiffness < 0)) return;
    hessian.stiffness[hessian.num_modes] = rest.area * stiffness;
    hessian.corners[hessian.num_modes++] = corners_of(rest, axes, a, b);
  };
  const Vec3 none = Vec3::Zero(), normal = u1.cross(u2);
  add(r1.stiffness, u1, none);
  add(r2.stiffness, none, u2);
  const bool are_equal = s1 - s2 < kNoLength;
  add(are_equal ? r1.stiffness : (r2.tension - r1.tension) / (s1 - s2), kHalfRoot * u2, kHalfRoot * u1);
  add(-(r1.tension + r2.tension) / std::max(s1 + s2, kNoLength), -kHalfRoot * u2, kHalfRoot * u1);
  add(-r1.tension / std::max(s1, kNoLength), normal, none);
  add(-r2.tension / std::max(s2, kNoLength), none, normal);
  return hessian;
}

Mat3 collapse_block(const CollapseHessian& hessian, int a, int b) {
  Mat3 block = Mat3::Zero();
  for (int m = 0; m < hessian.num_modes; ++m)
    block += hessian.stiffness[m] * hessian.corners[m][a] * hessian.corners[m][b].transpose();
  return block;
}

namespace {

class CollapseTerm final : public Term {
 public:
  CollapseTerm(const RestMesh& mesh, const StrainLimit& law) : mesh_(mesh), law_(law) {}

  double energy(const Positions& x) const override {
    double energy = 0;
    visit(x, [&](const Triangle&, const RestTriangle& rest, const TriangleCorners& corners) {
      energy += collapse_energy(rest, law_, corners);
    });
    return energy;
  }

  void add_force(const Positions& x, std::vector<Vec3>& force) const override {
    visit(x, [&](const Triangle& t, const RestTriangle& rest, const TriangleCorners& corners) {
      const TriangleCorners own = collapse_force(rest, law_, corners);
      for (int c = 0; c < 3; ++c) force[t[c]] += own[c];
    });
  }

  void add_hessian(const Positions& x, HessianKind kind, const AddBlock& add) const override {
    visit(x, [&](const Triangle& t, const RestTriangle& rest, const TriangleCorners& corners) {
      const CollapseHessian hessian = collapse_hessian(rest, law_, corners, kind);
      if (hessian.num_modes == 0) return;
      add_all_blocks(
          t.data(), 3, [&](int a, int b) { return collapse_block(hessian, a, b); }, add);
    });
  }

  void list_pairs(const AddPair& add) const override {
    for (const Triangle& t : mesh_.triangles) list_all_pairs(t.data(), 3, add);
  }

 private:
  template <class Visit>
  void visit(const Positions& x, const Visit& visit) const {
    for (int t = 0; t < mesh_.num_triangles(); ++t) {
      const auto& [a, b, c] = mesh_.triangles[t];
      visit(mesh_.triangles[t], make_rest_triangle(mesh_, t), TriangleCorners{x[a], x[b], x[c]});
    }
  }

  const RestMesh& mesh_;
  StrainLimit law_;
};

}  // namespace

std::unique_ptr<Term> make_collapse_term(const ClothModel& model, const ClothState&) {
  const StrainLimit law = make_collapse_law(model);
  if (law.stiffness == 0) return nullptr;
  return std::make_unique<CollapseTerm>(model.topology->mesh, law);
}

}  // namespace weft::engine
