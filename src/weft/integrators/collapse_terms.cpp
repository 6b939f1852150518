#include "weft/integrators/collapse_terms.h"

namespace weft::engine {
namespace {

constexpr double kMargin = 1.4;  // narrow triangles are below kCollapseBegin times this [1]

TriangleCorners corners_at(const std::array<int, 3>& at, const Vec3Array& x) {
  return {x.get(at[0]), x.get(at[1]), x.get(at[2])};
}

}  // namespace

void CollapseTerms::begin(const Step& step) {
  narrow_.clear();
  active_.clear();
  if (step.model.id == model_id_) return;
  model_id_ = step.model.id;
  topology_ = step.model.topology;
  rows_ = step.rows;
  law_ = make_collapse_law(step.model);
  finder_.fit(topology_, rows_, kMargin * kCollapseBegin);
}

double CollapseTerms::linearise(const Place& at, JobSystem& jobs, Vec3Array& force) {
  narrow_.clear();
  active_.clear();
  if (law_.stiffness == 0) return 0;
  double energy = 0;
  for (const int t : finder_.find(at.x, jobs)) {
    const auto& [a, b, c] = topology_->mesh.triangles[t];
    const Narrow& n = narrow_.emplace_back(
        Narrow{{rows_.index(a), rows_.index(b), rows_.index(c)}, make_rest_triangle(topology_->mesh, t)});
    const TriangleCorners corners = corners_at(n.at, at.x);
    const double own = collapse_energy(n.rest, law_, corners);
    if (own == 0) continue;
    energy += own;
    const TriangleCorners push = collapse_force(n.rest, law_, corners);
    for (int k = 0; k < 3; ++k) force.set(n.at[k], force.get(n.at[k]) + push[k]);
    active_.push_back({n.at, collapse_hessian(n.rest, law_, corners, HessianKind::positive)});
  }
  return energy;
}

double CollapseTerms::energy(const Place& at, JobSystem&) {
  double sum = 0;
  for (const Narrow& n : narrow_) sum += collapse_energy(n.rest, law_, corners_at(n.at, at.x));
  return sum;
}

double CollapseTerms::add_product(const Vec3Array& p, JobSystem&, Vec3Array& q) {
  double dot = 0;
  for (const Active& a : active_) {
    const TriangleCorners in = corners_at(a.at, p);
    TriangleCorners out = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
    for (int m = 0; m < a.hessian.num_modes; ++m) {
      const TriangleCorners& w = a.hessian.corners[m];
      const double along = w[0].dot(in[0]) + w[1].dot(in[1]) + w[2].dot(in[2]);
      const double pull = a.hessian.stiffness[m] * along;
      dot += pull * along;
      for (int k = 0; k < 3; ++k) out[k] += pull * w[k];
    }
    for (int k = 0; k < 3; ++k) q.set(a.at[k], q.get(a.at[k]) + out[k]);
  }
  return dot;
}

}  // namespace weft::engine
