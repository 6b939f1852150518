#pragma once
/// Seams: springs that draw borders together, and hold them (sewing springs). Each pulls a particle i and a point of
/// an edge j k:
///
///     E = ½ k max(0, |s| − r)²,   s = x_i − (1 − t) x_j − t x_k
///     r = r₀ + o max(0, l − r₀)
///
/// with the distance l in the mesh, the opening o, which falls from 1 to 0 in Seams::time T, o = 1 − 3 u² + 2 u³ for u = t/T,
/// and the distance r₀ of a closed seam. Seams pull, and never push: cloth that moves on by itself closes earlier.
/// Contact keeps layers a thickness apart; r₀ is a little more, so that the two do not work against each other.

#include <memory>
#include <optional>

#include "weft/core/vec.h"
#include "weft/forces/term.h"
#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

/// r₀ [m].
double closed_seam(const ClothModel& model);

/// o [1].
double seam_opening(const ClothModel& model, const ClothState& state);

/// For the start of a step: the seams close by that time [s].
void advance_seams(const ClothModel& model, double step, ClothState& state);

/// Whether closing seams do work, now or a moment ago.
bool are_seams_closing(const ClothModel& model, const ClothState& state);

struct SeamPull {
  double energy = 0;          // [J]
  Vec3 force = Vec3::Zero();  // on `s`: on particle p it is its weight times this [N]
  double along = 0;           // stiffness along s [N/m]
  double across = 0;          // and across it [N/m]
  Vec3 direction = Vec3::Zero();

  Mat3 hessian() const {
    return across * Mat3::Identity() + (along - across) * direction * direction.transpose();
  }
};

/// `at(particle)` is a position.
template <class At>
Vec3 seam_gap(const SeamSpring& spring, const At& at) {
  const auto& [i, j, k] = spring.particles;
  return at(i) - (1 - spring.share) * at(j) - spring.share * at(k);
}

/// Of a spring with this s; zero where it is slack.
SeamPull seam_pull(const SeamSpring& spring, double closed, double opening, const Vec3& gap);

/// Calls visit(spring, pull) for each spring that is not slack, in order.
template <class At, class Visit>
void visit_seam_pulls(const ClothModel& model, double opening, const At& at, const Visit& visit) {
  const double closed = closed_seam(model);
  for (const SeamSpring& spring : model.topology->seams.springs) {
    const SeamPull pull = seam_pull(spring, closed, opening, seam_gap(spring, at));
    if (pull.along > 0) visit(spring, pull);
  }
}

/// Null for a cloth without seams.
std::unique_ptr<Term> make_seam_term(const ClothModel& model, const ClothState& state);

/// Work of the closing seams in a step: the pull at its end times the shortening of r [J].
double seam_work(const ClothModel& model, const ClothState& before, const ClothState& after);

/// A seam that is open though its time is over: by more than r₀, and a quarter of an edge.
struct OpenSeam {
  double width = 0;  // |s| − r₀ [m]
  int particle = -1;
};
/// The widest; empty if there is none.
std::optional<OpenSeam> find_open_seam(const ClothModel& model, const ClothState& state);

}  // namespace weft::engine
