#include "weft/forces/spring_terms.h"

#include <algorithm>

#include "weft/forces/damping.h"
#include "weft/forces/spring.h"

namespace weft::engine {
namespace {

/// Adds a spring's block to both of its ends.
void add_spring(const Spring& s, const Mat3& block, const Term::AddBlock& add) {
  add(s.i, s.i, block);
  add(s.j, s.j, block);
  add(s.i, s.j, -block);
}

enum class Springs { stretch, bend };

/// Springs without stiffness have pairs too: these depend on the topology alone.
class SpringTerm final : public Term {
 public:
  SpringTerm(const ClothModel& model, Springs which) : model_(model), which_(which) {
    if (model.elements && which == Springs::stretch) limit_ = model.elements->spring_limit;
  }

  double energy(const Positions& x) const override {
    double energy = 0;
    visit([&](const Spring& s, double k) {
      if (k > 0) energy += spring_energy(k, s.rest_length, x[s.j] - x[s.i]);
      if (is_limited()) energy += s.rest_length * limit_of(s, x).energy;
    });
    return energy;
  }

  void add_force(const Positions& x, std::vector<Vec3>& force) const override {
    visit([&](const Spring& s, double k) {
      const Vec3 d = x[s.j] - x[s.i];
      Vec3 pull = spring_force(k, s.rest_length, d);
      const double tension = is_limited() ? limit_of(s, x).tension : 0.0;
      if (tension > 0) pull += tension * d.normalized();
      force[s.i] += pull;
      force[s.j] -= pull;
    });
  }

  void add_hessian(const Positions& x, HessianKind kind, const AddBlock& add) const override {
    const bool is_exact = kind == HessianKind::exact;
    visit([&](const Spring& s, double k) {
      const Vec3 d = x[s.j] - x[s.i];
      Mat3 block =
          is_exact ? spring_jacobian(k, s.rest_length, d) : spring_jacobian_clamped(k, s.rest_length, d);
      if (is_limited()) block += limit_jacobian(s, x);
      add_spring(s, block, add);
    });
  }

  void list_pairs(const AddPair& add) const override {
    visit([&](const Spring& s, double) { add(s.i, s.j); });
  }

  bool is_beyond_limit(const Positions& x) const override {
    if (!is_limited()) return false;
    bool is_beyond = false;
    visit([&](const Spring& s, double) {
      is_beyond |= (x[s.j] - x[s.i]).norm() > (1 + limit_.allowed()) * s.rest_length;
    });
    return is_beyond;
  }

 private:
  template <class Visit>
  void visit(const Visit& visit) const {
    for (int k = 0; const Spring& s : model_.topology->springs) {
      if ((s.kind == SpringKind::bend) == (which_ == Springs::bend)) visit(s, model_.stiffness(k));
      ++k;
    }
  }

  bool is_limited() const { return limit_.stiffness > 0; }

  LimitResponse limit_of(const Spring& s, const Positions& x) const {
    return limit_response(limit_, (x[s.j] - x[s.i]).norm() / s.rest_length - 1);
  }

  /// Tension-only: positive semidefinite without projection.
  Mat3 limit_jacobian(const Spring& s, const Positions& x) const {
    const Vec3 d = x[s.j] - x[s.i];
    const LimitResponse r = limit_of(s, x);
    if (r.tension == 0) return Mat3::Zero();
    const Mat3 along = d * d.transpose() / d.squaredNorm();
    return r.stiffness / s.rest_length * along + r.tension / d.norm() * (Mat3::Identity() - along);
  }

  const ClothModel& model_;
  Springs which_;
  StrainLimit limit_;
};

class SpringDampingTerm final : public Term {
 public:
  SpringDampingTerm(const ClothModel& model, const Motion& motion) : model_(model), motion_(motion) {}

  double energy(const Positions& x) const override {
    double energy = 0;
    visit([&](const Spring& s, double b) {
      const Vec3 w = velocity(s, x);
      energy += 0.5 * motion_.step * w.dot(pull(s, b, w));
    });
    return energy;
  }

  void add_force(const Positions& x, std::vector<Vec3>& force) const override {
    visit([&](const Spring& s, double b) {
      const Vec3 own = pull(s, b, velocity(s, x));
      force[s.i] += own;
      force[s.j] -= own;
    });
  }

  void add_hessian(const Positions&, HessianKind, const AddBlock& add) const override {
    visit([&](const Spring& s, double b) {
      add_spring(
          s,
          (is_plain() ? plain_damping_jacobian(b) : projected_damping_jacobian(b, along(s))) / motion_.step,
          add);
    });
  }

  void list_pairs(const AddPair& add) const override {
    visit([&](const Spring& s, double) { add(s.i, s.j); });
  }

 private:
  template <class Visit>
  void visit(const Visit& visit) const {
    for (int k = 0; const Spring& s : model_.topology->springs) visit(s, model_.damping(k++));
  }
  bool is_plain() const { return model_.material.damping_kind == DampingKind::plain; }
  Vec3 along(const Spring& s) const { return motion_.shape[s.j] - motion_.shape[s.i]; }
  Vec3 velocity(const Spring& s, const Positions& x) const {
    return motion_.velocity(x, s.j) - motion_.velocity(x, s.i);
  }
  Vec3 pull(const Spring& s, double b, const Vec3& w) const {
    return is_plain() ? plain_damping_force(b, w) : projected_damping_force(b, along(s), w);
  }

  const ClothModel& model_;
  Motion motion_;
};

std::unique_ptr<Term> make_spring_term(const ClothModel& model, Springs which) {
  const auto is_one = [&](const Spring& s) {
    return (s.kind == SpringKind::bend) == (which == Springs::bend);
  };
  if (std::ranges::none_of(model.topology->springs, is_one)) return nullptr;
  return std::make_unique<SpringTerm>(model, which);
}

}  // namespace

std::unique_ptr<Term> make_stretch_spring_term(const ClothModel& model, const ClothState&) {
  return make_spring_term(model, Springs::stretch);
}

std::unique_ptr<Term> make_bend_spring_term(const ClothModel& model, const ClothState&) {
  return make_spring_term(model, Springs::bend);
}

std::unique_ptr<Term> make_spring_damping_term(const ClothModel& model, const Motion& motion) {
  if (model.material.damping == 0 && model.material.damping_time == 0) return nullptr;
  return std::make_unique<SpringDampingTerm>(model, motion);
}

}  // namespace weft::engine
