#include "weft/forces/seam_springs.h"

#include <algorithm>

namespace weft::engine {

double closed_seam(const ClothModel& model) {
  constexpr double kThicknesses = 1.2;
  return kThicknesses * model.material.thickness;
}

double seam_opening(const ClothModel& model, const ClothState& state) {
  const double time = model.topology->seams.time;
  if (state.seam_time >= time) return 0;
  const double share = state.seam_time / time;
  return 1 - share * share * (3 - 2 * share);
}

void advance_seams(const ClothModel& model, double step, ClothState& state) {
  if (!model.topology->seams.springs.empty()) state.seam_time += step;
}

bool are_seams_closing(const ClothModel& model, const ClothState& state) {
  constexpr double kMoment = 0.05;  // a frame of film and more [s]
  const Seams& seams = model.topology->seams;
  return !seams.springs.empty() && state.seam_time < seams.time + kMoment;
}

SeamPull seam_pull(const SeamSpring& spring, double closed, double opening, const Vec3& gap) {
  const double slack = closed + opening * std::max(0.0, spring.start - closed);
  const double length = gap.norm(), stretch = length - slack;
  if (!(stretch > 0)) return {};
  const double k = spring.stiffness;
  const Vec3 direction = gap / length;
  return {0.5 * k * stretch * stretch, -k * stretch * direction, k, k * stretch / length, direction};
}

namespace {

class SeamTerm final : public Term {
 public:
  SeamTerm(const ClothModel& model, double opening) : model_(model), opening_(opening) {}

  double energy(const Positions& x) const override {
    double energy = 0;
    visit(x, [&](const SeamSpring&, const SeamPull& pull) { energy += pull.energy; });
    return energy;
  }

  void add_force(const Positions& x, std::vector<Vec3>& force) const override {
    visit(x, [&](const SeamSpring& spring, const SeamPull& pull) {
      const auto weights = spring.weights();
      for (int k = 0; k < 3; ++k) force[spring.particles[k]] += weights[k] * pull.force;
    });
  }

  void add_hessian(const Positions& x, HessianKind, const AddBlock& add) const override {
    visit(x, [&](const SeamSpring& spring, const SeamPull& pull) {
      const auto weights = spring.weights();
      const Mat3 hessian = pull.hessian();
      add_all_blocks(
          spring.particles.data(), 3, [&](int a, int b) { return Mat3(weights[a] * weights[b] * hessian); },
          add);
    });
  }

  void list_pairs(const AddPair& add) const override {
    for (const SeamSpring& spring : model_.topology->seams.springs)
      list_all_pairs(spring.particles.data(), 3, add);
  }

 private:
  template <class Visit>
  void visit(const Positions& x, const Visit& visit) const {
    visit_seam_pulls(
        model_, opening_, [&](int v) { return x[v]; }, visit);
  }

  const ClothModel& model_;
  double opening_;
};

}  // namespace

std::unique_ptr<Term> make_seam_term(const ClothModel& model, const ClothState& state) {
  if (model.topology->seams.springs.empty()) return nullptr;
  return std::make_unique<SeamTerm>(model, seam_opening(model, state));
}

double seam_work(const ClothModel& model, const ClothState& before, const ClothState& after) {
  const double closed = closed_seam(model), fall = seam_opening(model, before) - seam_opening(model, after);
  double work = 0;
  visit_seam_pulls(
      model, seam_opening(model, after), [&](int v) { return after.x.get(v); },
      [&](const SeamSpring& spring, const SeamPull& pull) {
        work += pull.force.norm() * fall * std::max(0.0, spring.start - closed);
      });
  return work;
}

std::optional<OpenSeam> find_open_seam(const ClothModel& model, const ClothState& state) {
  constexpr double kShareOfEdge = 0.25;
  const ClothTopology& topology = *model.topology;
  const double closed = closed_seam(model);
  std::optional<OpenSeam> widest;
  if (state.seam_time < topology.seams.time) return widest;
  for (const SeamSpring& spring : topology.seams.springs) {
    const auto& [i, j, k] = spring.particles;
    const double edge = (topology.mesh.positions[k] - topology.mesh.positions[j]).norm();
    const double width = seam_gap(spring, [&](int v) { return state.x.get(v); }).norm() - closed;
    if (width > std::max(closed, kShareOfEdge * edge) && (!widest || width > widest->width))
      widest = {width, i};
  }
  return widest;
}

}  // namespace weft::engine
