#include "weft/forces/thread_bends.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "weft/mesh/vertex_normals.h"

namespace weft::engine {
namespace {

/// Unit normals of the vertices; zero where the triangles around a vertex have none.
std::vector<Vec3> find_normals(const TriangleMesh& mesh, const ClothState& state) {
  std::vector<Vec3> normals =
      sum_triangle_normals(mesh.triangles, mesh.positions.size(), [&](int v) { return state.x.get(v); });
  for (Vec3& normal : normals) {
    const double length = normal.norm();
    if (length > 0) normal /= length;
  }
  return normals;
}

std::vector<double> as_doubles(const std::vector<float>& values, int count) {
  if (std::cmp_not_equal(values.size(), count)) return std::vector<double>(count, 0.0);
  return {values.begin(), values.end()};
}

/// The nearest value to `memory` that `value` is at most `distance` away from.
double follow(double memory, double value, double distance) {
  return std::clamp(memory, value - distance, value + distance);
}

}  // namespace

const ThreadBends& thread_bends_of(const ClothModel& model) {
  static const ThreadBends kNone;
  return model.elements ? model.elements->thread_bends : kNone;
}

ThreadBendStep begin_thread_bends(const ThreadBends& rows, const TriangleMesh& mesh,
                                  const ClothState& state) {
  ThreadBendStep step{.rows = &rows};
  if (rows.empty()) return step;
  const std::vector<Vec3> normals = find_normals(mesh, state);
  for (const int v : rows.center) step.normal.push_back(normals[v]);
  step.slip = as_doubles(state.bending.slip, rows.num_rows());
  step.set = as_doubles(state.bending.set, rows.num_rows());
  for (int r = 0; r < rows.num_rows(); ++r) {
    const double curvature = thread_curvature(step, r, [&](int v) { return state.x.get(v); });
    step.slip[r] = follow(step.slip[r], curvature, kSlipCurvature);
    if (rows.set > 0) step.set[r] = follow(step.set[r], curvature, rows.set);
  }
  return step;
}

void advance_thread_bends(const ClothModel& model, ClothState& state) {
  const ThreadBendStep step = begin_thread_bends(thread_bends_of(model), model.topology->mesh, state);
  state.bending.slip.assign(step.slip.begin(), step.slip.end());
  state.bending.set.assign(step.set.begin(), step.set.end());
}

ThreadBendResponse thread_bend_response(const ThreadBendStep& step, int row, double curvature) {
  const double friction = step.rows->friction[row], set = step.set[row];
  const double elastic = step.rows->set > 0 ? step.rows->stiffness[row] : 0;
  const double apart = curvature - step.slip[row], distance = std::abs(apart);
  ThreadBendResponse response{.energy = elastic * set * (0.5 * set - curvature), .moment = -elastic * set};
  if (distance <= kSlipCurvature) {
    response.energy += 0.5 * friction / kSlipCurvature * apart * apart;
    response.stiffness = response.tangent = friction / kSlipCurvature;
  } else {
    response.energy += friction * (distance - 0.5 * kSlipCurvature);
    response.stiffness = friction / distance;
  }
  response.moment += response.stiffness * apart;
  return response;
}

namespace {

class ThreadBendTerm final : public Term {
 public:
  explicit ThreadBendTerm(ThreadBendStep step) : step_(std::move(step)), rows_(*step_.rows) {}

  double energy(const Positions& x) const override {
    double energy = 0;
    for (int r = 0; r < rows_.num_rows(); ++r) energy += respond(r, x).energy;
    return energy;
  }

  void add_force(const Positions& x, std::vector<Vec3>& force) const override {
    for (int r = 0; r < rows_.num_rows(); ++r) {
      const Vec3 moment = respond(r, x).moment * step_.normal[r];
      for (int k = rows_.begin[r]; k < rows_.begin[r + 1]; ++k)
        force[rows_.vertex[k]] -= rows_.weight[k] * moment;
    }
  }

  void add_hessian(const Positions& x, HessianKind kind, const AddBlock& add) const override {
    for (int r = 0; r < rows_.num_rows(); ++r) {
      const ThreadBendResponse response = respond(r, x);
      const Vec3& n = step_.normal[r];
      const Mat3 block =
          (kind == HessianKind::exact ? response.tangent : response.stiffness) * n * n.transpose();
      const double* weight = &rows_.weight[rows_.begin[r]];
      add_all_blocks(
          &rows_.vertex[rows_.begin[r]], rows_.begin[r + 1] - rows_.begin[r],
          [&](int a, int b) { return Mat3(weight[a] * weight[b] * block); }, add);
    }
  }

  void list_pairs(const AddPair& add) const override {
    for (int r = 0; r < rows_.num_rows(); ++r)
      list_all_pairs(rows_.vertex.data() + rows_.begin[r], rows_.begin[r + 1] - rows_.begin[r], add);
  }

 private:
  ThreadBendResponse respond(int row, const Positions& x) const {
    return thread_bend_response(step_, row, thread_curvature(step_, row, [&](int v) { return x[v]; }));
  }

  ThreadBendStep step_;
  const ThreadBends& rows_;
};

}  // namespace

std::unique_ptr<Term> make_thread_bend_term(const ClothModel& model, const ClothState& state) {
  const ThreadBends& rows = thread_bends_of(model);
  if (rows.empty()) return nullptr;
  return std::make_unique<ThreadBendTerm>(begin_thread_bends(rows, model.topology->mesh, state));
}

}  // namespace weft::engine
