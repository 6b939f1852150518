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

/// The state's memory, moved to its positions.
ThreadBendStep follow_thread_bends(const ThreadBends& rows, const TriangleMesh& mesh,
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

ThreadBendStep follow_thread_bends(const ClothModel& model, const ClothState& state) {
  return follow_thread_bends(thread_bends_of(model), model.topology->mesh, state);
}

}  // namespace

const ThreadBends& thread_bends_of(const ClothModel& model) {
  static const ThreadBends kNone;
  return model.elements ? model.elements->thread_bends : kNone;
}

ThreadBendStep begin_thread_bends(const ThreadBends& rows, const TriangleMesh& mesh, ClothState& state) {
  ThreadBendStep step = follow_thread_bends(rows, mesh, state);
  state.bending.slip.assign(step.slip.begin(), step.slip.end());
  state.bending.set.assign(step.set.begin(), step.set.end());
  return step;
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

double thread_bend_energy(const ClothModel& model, const ClothState& state) {
  const ThreadBendStep step = follow_thread_bends(model, state);
  double energy = 0;
  for (int r = 0; r < step.rows->num_rows(); ++r) {
    const double curvature = thread_curvature(step, r, [&](int v) { return state.x.get(v); });
    energy += thread_bend_response(step, r, curvature).energy;
  }
  return energy;
}

void add_thread_bend_force(const ClothModel& model, const ClothState& state, std::vector<Vec3>& force) {
  const ThreadBendStep step = follow_thread_bends(model, state);
  const ThreadBends& rows = *step.rows;
  for (int r = 0; r < rows.num_rows(); ++r) {
    const double curvature = thread_curvature(step, r, [&](int v) { return state.x.get(v); });
    const Vec3 moment = thread_bend_response(step, r, curvature).moment * step.normal[r];
    for (int k = rows.begin[r]; k < rows.begin[r + 1]; ++k) force[rows.vertex[k]] -= rows.weight[k] * moment;
  }
}

}  // namespace weft::engine
