#pragma once
/// Bending with memory: friction between threads, and creases. A Prandtl element beside the elastic rigidity D, for
/// the curvature κ of each thread (rows of fabric/bending_rows.h):
///
///     M = D (κ − κ_set) + H clamp((κ − κ_slip)/s, −1, 1),     H = 2HB/2, s = kSlipCurvature
///
///       M ↑      ______/              On a bending tester the branches are straight lines of slope D, at a distance
///         |  ___/  ___/               of 2HB (P. Grosberg, The Mechanical Properties of Woven Fabrics, Part II,
///         | /  ___/  | 2HB            Textile Research Journal 36, 1966; S. Kawabata 1980). Where bending turns,
///         |/__/                       threads stick until κ has changed by 2 s.
///     ----+--------→ κ
///
/// Before each step κ_slip follows κ at a distance of at most s, and κ_set at one of at most `set`: both only lose
/// energy. Bent to κ and let go, a strip without other forces keeps κ_set + H/D, or less after little bending.
///
/// For the step the element is the convex potential of J.-J. Moreau's sweeping process, quadratic around κ_slip and
/// linear beyond s, so that an implicit step slips by the right amount.

#include <memory>
#include <vector>

#include "weft/core/vec.h"
#include "weft/forces/term.h"
#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

/// Change of curvature at which threads begin to slip [1/m]. A tenth of the curvature at which KES-F reads 2HB, so that
/// its reading is the moment of sliding threads.
constexpr double kSlipCurvature = 10;

/// What rows need beside positions in a step.
struct ThreadBendStep {
  const ThreadBends* rows = nullptr;
  std::vector<Vec3> normal;       // of the cloth at each row's centre, at the start of the step (num_rows)
  std::vector<double> slip, set;  // BendingMemory (num_rows) [1/m]
};

/// The rows of a cloth, or none.
const ThreadBends& thread_bends_of(const ClothModel& model);

/// Moves the memory of the state to its positions. A state without memory has been flat until now.
void advance_thread_bends(const ClothModel& model, ClothState& state);

/// A step from the state, as if its memory had been moved. The rows outlive it.
ThreadBendStep begin_thread_bends(const ThreadBends& rows, const TriangleMesh& mesh, const ClothState& state);

/// n·Σ w x of a row [1/m]; `position(vertex)` is a Vec3.
template <class Position>
double thread_curvature(const ThreadBendStep& step, int row, const Position& position) {
  const ThreadBends& rows = *step.rows;
  const Vec3 first = position(rows.vertex[rows.begin[row]]);
  Vec3 sum = Vec3::Zero();
  for (int k = rows.begin[row] + 1; k < rows.begin[row + 1]; ++k)
    sum += rows.weight[k] * (position(rows.vertex[k]) - first);
  return step.normal[row].dot(sum);
}

/// What a row adds to elastic bending at a curvature. `stiffness` is the moment of friction over κ − κ_slip: the parabola
/// with it is nowhere below the energy.
struct ThreadBendResponse {
  double energy = 0;     // negative where elastic bending counts too much, at κ near κ_set [J]
  double moment = 0;     // ∂energy/∂κ [N·m²]
  double stiffness = 0;  // [N·m³]
  double tangent = 0;    // ∂moment/∂κ [N·m³]
};
ThreadBendResponse thread_bend_response(const ThreadBendStep& step, int row, double curvature);

/// What friction and set add to elastic bending in a step from the state; null without rows.
std::unique_ptr<Term> make_thread_bend_term(const ClothModel& model, const ClothState& state);

}  // namespace weft::engine
