#include "weft/integrators/implicit_cloth.h"

#include <algorithm>
#include <cmath>

#include "weft/forces/damping.h"
#include "weft/forces/spring.h"
#include "weft/integrators/common.h"
#include "weft/integrators/newton_kernels.h"

namespace weft::engine {
namespace {

TriangleCorners corners_of(const MembraneElement& triangle, const std::vector<Vec3>& x) {
  const auto& [a, b, c] = triangle.vertices;
  return {x[a], x[b], x[c]};
}

}  // namespace

void ImplicitCloth::begin(const Body& body, double step, Order order, Keeps keeps) {
  order_ = order;
  keeps_ = keeps;
  model_ = body.model;
  environment_ = body.environment;
  state_ = body.state;
  whole_step_ = step;
  find_triangles();
  collapse_law_ = make_collapse_law(*model_);
  is_pinned_.assign(model_->num_particles(), 0);
  for (const int p : pinned()) is_pinned_[p] = 1;
  thread_bends_ = begin_thread_bends(thread_bends_of(*model_), model_->topology->mesh, *state_);
  advance_seams(*model_, step, *state_);
  load();
  start_from(before_.x, before_.v, step);
  if (order_ == Order::second && state_->history.step == 0) synthesize_history();
}

/// Every triangle edge is a spring of the topology, so the pattern has its block.
void ImplicitCloth::find_triangles() {
  if (topology_ == model_->topology) return;
  topology_ = model_->topology;
  const RestMesh& mesh = topology_->mesh;
  triangles_.clear();
  for (int t = 0; t < mesh.num_triangles(); ++t)
    triangles_.push_back({mesh.triangles[t], make_rest_triangle(mesh, t)});
}

/// The state at the start of the step, in the stored precision.
void ImplicitCloth::load() {
  static const std::vector<Vec3> kNone;
  const auto copy = [&](const Vec3Array& values, const std::vector<Vec3>& precise, std::vector<Vec3>& to) {
    to.resize(values.size());
    for (std::size_t i = 0; i < to.size(); ++i)
      to[i] = most_precise(keeps_ == Keeps::doubles ? precise : kNone, values, i);
  };
  copy(state_->x, state_->precise.x, before_.x);
  copy(state_->v, state_->precise.v, before_.v);
  if (order_ == Order::first || state_->history.step == 0) return;
  copy(state_->history.displacement, state_->precise.displacement, before_.displacement);
  copy(state_->history.velocity, state_->precise.velocity, before_.velocity);
}

/// Starts a step of implicit Euler from x and v [s].
void ImplicitCloth::start_from(const std::vector<Vec3>& x, const std::vector<Vec3>& v, double time) {
  step_ = time;
  start_ = x;
  inertial_.resize(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    inertial_[i] = x[i] + time * v[i] + time * time * (environment_->gravity + environment_->external(i));
}

/// Initial history, as in `newton`: of cloth in free fall as far as nothing carries it.
void ImplicitCloth::synthesize_history() {
  const double step = whole_step_;
  std::vector<Vec3> gradient(before_.x.size(), Vec3::Zero());
  add_spring_gradient(before_.x, gradient);
  if (model_->elements) {
    elements_.begin_step(*model_->elements, step, before_.x, before_.x);
    elements_.add_gradient(before_.x, gradient);
  }
  const Vec3& gravity = environment_->gravity;
  const auto elastic = [&](int i) -> Vec3 { return is_pinned_[i] ? Vec3(Vec3::Zero()) : Vec3(-gradient[i]); };
  const Vec3 a = free_share(*model_, pinned(), gravity, elastic) * gravity;
  before_.displacement.resize(before_.x.size());
  before_.velocity.resize(before_.x.size());
  for (std::size_t i = 0; i < before_.x.size(); ++i) {
    const Vec3 all = a + environment_->external(i);
    before_.displacement[i] = step * before_.v[i] - 0.5 * step * step * all;
    before_.velocity[i] = before_.v[i] - step * all;
  }
}

void ImplicitCloth::begin_second_order() {
  const double step_before = state_->history.step > 0 ? state_->history.step : whole_step_;
  const StepScheme bdf2 = make_bdf2(whole_step_, step_before);
  std::vector<Vec3> x = before_.x, v = before_.v;
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] += bdf2.memory * before_.displacement[i];
    v[i] += bdf2.memory * (before_.v[i] - before_.velocity[i]);
  }
  start_from(x, v, whole_step_ / bdf2.beta);
}

void ImplicitCloth::place_pins() {
  air_.begin(*model_, *environment_, *state_);
  air_.set_still(1 / step_);
  placed_ = inertial_;
  const PinTargets& pins = environment_->pins;
  for (std::size_t p = 0; p < pins.particle.size(); ++p) {
    const int i = pins.particle[p];
    placed_[i] = pins.position[p] - state_->origin;
    if (step_ < whole_step_)  // velocity: over the whole step
      start_[i] = placed_[i] - step_ / whole_step_ * (placed_[i] - before_.x[i]);
  }
  damped_shape_ = step_ < whole_step_ ? placed_ : start_;
  if (model_->elements) elements_.begin_step(*model_->elements, step_, start_, damped_shape_);
}

double ImplicitCloth::energy(const std::vector<Vec3>& x) const {
  const Wind& wind = environment_->wind;
  double energy = model_->elements ? elements_.energy(x) : 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (is_pinned_[i]) continue;
    if (air_.is_active()) energy += air_.energy(static_cast<int>(i), x[i] - start_[i]);
    const Vec3 slip = (x[i] - start_[i]) / step_ - wind.velocity;
    energy += 0.5 * model_->mass[i] / (step_ * step_) * (x[i] - inertial_[i]).squaredNorm() +
              0.5 * step_ * wind.drag * model_->topology->area[i] * slip.squaredNorm();
  }
  for (int k = 0; k < num_springs(); ++k) {
    const Spring& s = spring(k);
    energy += spring_energy(model_->stiffness(k), s.rest_length, x[s.j] - x[s.i]);
    if (is_limited(s)) energy += s.rest_length * limit_of(s, x).energy;
    if (is_damped()) {
      energy += 0.5 * step_ * relative_velocity(s, x).dot(damping_force(k, relative_velocity(s, x)));
    }
  }
  for (const MembraneElement& t : triangles_)
    energy += collapse_energy(t.rest, collapse_law_, corners_of(t, x));
  for (int r = 0; r < thread_bends_.rows->num_rows(); ++r) energy += thread_response(r, x).energy;
  visit_seams(x, [&](const SeamSpring&, const SeamPull& pull) { energy += pull.energy; });
  return model_->gas.is_active() ? energy + gas_energy(model_->gas, volume(x)) : energy;
}

ThreadBendResponse ImplicitCloth::thread_response(int row, const std::vector<Vec3>& x) const {
  return thread_bend_response(thread_bends_, row,
                              thread_curvature(thread_bends_, row, [&](int v) { return x[v]; }));
}

double ImplicitCloth::volume(const std::vector<Vec3>& x) const {
  return model_->gas.orientation *
         compute_signed_volume(model_->topology->mesh.triangles, [&](int v) { return x[v]; });
}

std::optional<ImplicitCloth::GasHessian> ImplicitCloth::gas_hessian(const std::vector<Vec3>& x) const {
  if (!model_->gas.is_sealed()) return std::nullopt;
  GasHessian hessian{gas_stiffness(model_->gas, volume(x)), std::vector<Vec3>(x.size(), Vec3::Zero())};
  add_volume_gradient(
      model_->topology->mesh.triangles, [&](int v) { return x[v]; },
      [&](int v, const Vec3& part) { hessian.gradient[v] += part; });
  return hessian;
}

Vec3 ImplicitCloth::relative_velocity(const Spring& s, const std::vector<Vec3>& x) const {
  return ((x[s.j] - start_[s.j]) - (x[s.i] - start_[s.i])) / step_;
}

/// Projected damping acts along the spring at the start of the step, or for second order along its
/// prediction: the potential stays quadratic.
Vec3 ImplicitCloth::damping_force(int k, const Vec3& w) const {
  const double b = model_->damping(k);
  if (model_->material.damping_kind == DampingKind::plain) return plain_damping_force(b, w);
  const Spring& s = spring(k);
  return projected_damping_force(b, damped_shape_[s.j] - damped_shape_[s.i], w);
}

Mat3 ImplicitCloth::damping_jacobian(int k) const {
  const double b = model_->damping(k);
  if (model_->material.damping_kind == DampingKind::plain) return plain_damping_jacobian(b);
  const Spring& s = spring(k);
  return projected_damping_jacobian(b, damped_shape_[s.j] - damped_shape_[s.i]);
}

bool ImplicitCloth::is_limited(const Spring& s) const {
  return model_->elements && model_->elements->spring_limit.stiffness > 0 && s.kind != SpringKind::bend;
}

LimitResponse ImplicitCloth::limit_of(const Spring& s, const std::vector<Vec3>& x) const {
  return limit_response(model_->elements->spring_limit, (x[s.j] - x[s.i]).norm() / s.rest_length - 1);
}

/// Tension-only: positive semidefinite without projection.
Mat3 ImplicitCloth::limit_jacobian(const Spring& s, const std::vector<Vec3>& x) const {
  const Vec3 d = x[s.j] - x[s.i];
  const LimitResponse r = limit_of(s, x);
  if (r.tension == 0) return Mat3::Zero();
  const Mat3 along = d * d.transpose() / d.squaredNorm();
  return r.stiffness / s.rest_length * along + r.tension / d.norm() * (Mat3::Identity() - along);
}

void ImplicitCloth::add_spring_gradient(const std::vector<Vec3>& x, std::vector<Vec3>& gradient) const {
  for (int k = 0; k < num_springs(); ++k) {
    const Spring& s = spring(k);
    Vec3 force = spring_force(model_->stiffness(k), s.rest_length, x[s.j] - x[s.i]);
    if (is_limited(s)) force += limit_of(s, x).tension * (x[s.j] - x[s.i]).normalized();
    gradient[s.i] -= force;
    gradient[s.j] += force;
  }
}

void ImplicitCloth::add_gradient(const std::vector<Vec3>& x, std::vector<Vec3>& gradient) const {
  const Wind& wind = environment_->wind;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 velocity = (x[i] - start_[i]) / step_;
    gradient[i] += model_->mass[i] / (step_ * step_) * (x[i] - inertial_[i]) -
                   wind_force(wind, model_->topology->area[i], velocity);
    if (air_.is_active()) gradient[i] -= air_.force(static_cast<int>(i), x[i] - start_[i]);
  }
  add_spring_gradient(x, gradient);
  for (int k = 0; k < (is_damped() ? num_springs() : 0); ++k) {
    const Spring& s = spring(k);
    const Vec3 force = damping_force(k, relative_velocity(s, x));
    gradient[s.i] -= force;
    gradient[s.j] += force;
  }
  if (model_->elements) elements_.add_gradient(x, gradient);
  for (const MembraneElement& t : triangles_) {
    const TriangleCorners force = collapse_force(t.rest, collapse_law_, corners_of(t, x));
    for (int c = 0; c < 3; ++c) gradient[t.vertices[c]] -= force[c];
  }
  const ThreadBends& bends = *thread_bends_.rows;
  for (int r = 0; r < bends.num_rows(); ++r) {
    const Vec3 moment = thread_response(r, x).moment * thread_bends_.normal[r];
    for (int k = bends.begin[r]; k < bends.begin[r + 1]; ++k)
      gradient[bends.vertex[k]] += bends.weight[k] * moment;
  }
  visit_seams(x, [&](const SeamSpring& spring, const SeamPull& pull) {
    const auto weights = spring.weights();
    for (int k = 0; k < 3; ++k) gradient[spring.particles[k]] -= weights[k] * pull.force;
  });
  if (!model_->gas.is_active()) return;
  const double excess = model_->gas.orientation * gas_excess(model_->gas, volume(x));
  add_volume_gradient(
      model_->topology->mesh.triangles, [&](int v) { return x[v]; },
      [&](int v, const Vec3& part) { gradient[v] -= excess * part; });
}

void ImplicitCloth::add_hessian(const std::vector<Vec3>& x, bool is_true, const AddBlock& add,
                                const SetSpring& set_spring) const {
  const Wind& wind = environment_->wind;
  for (int i = 0; i < static_cast<int>(x.size()); ++i) {
    const double inertia = model_->mass[i] / (step_ * step_);
    Mat3 block = inertia * Mat3::Identity() - wind_jacobian(wind, model_->topology->area[i]) / step_;
    if (air_.is_active()) block += air_.hessian(i);
    add(i, i, block);
  }
  for (int p = 0; p < num_springs(); ++p) {
    const Spring& s = spring(p);
    const double k = model_->stiffness(p);
    const Vec3 d = x[s.j] - x[s.i];
    Mat3 block =
        is_true ? spring_jacobian(k, s.rest_length, d) : spring_jacobian_clamped(k, s.rest_length, d);
    if (is_damped()) block += damping_jacobian(p) / step_;
    if (is_limited(s)) block += limit_jacobian(s, x);
    add(s.i, s.i, block);
    add(s.j, s.j, block);
    set_spring(p, -block);
  }
  if (model_->elements) elements_.add_hessian(x, is_true ? StressFilter::exact : StressFilter::absolute, add);
  const CollapseFilter filter = is_true ? CollapseFilter::exact : CollapseFilter::positive;
  for (const MembraneElement& t : triangles_) {
    const CollapseHessian hessian = collapse_hessian(t.rest, collapse_law_, corners_of(t, x), filter);
    if (hessian.num_modes == 0) continue;
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b <= a; ++b) add(t.vertices[a], t.vertices[b], collapse_block(hessian, a, b));
    }
  }
  const ThreadBends& bends = *thread_bends_.rows;
  for (int r = 0; r < bends.num_rows(); ++r) {
    const ThreadBendResponse response = thread_response(r, x);
    const Vec3& n = thread_bends_.normal[r];
    const Mat3 block = (is_true ? response.tangent : response.stiffness) * n * n.transpose();
    for (int a = bends.begin[r]; a < bends.begin[r + 1]; ++a) {
      for (int b = bends.begin[r]; b <= a; ++b)
        add(bends.vertex[a], bends.vertex[b], bends.weight[a] * bends.weight[b] * block);
    }
  }
  visit_seams(x, [&](const SeamSpring& spring, const SeamPull& pull) {
    const auto weights = spring.weights();
    const Mat3 hessian = pull.hessian();
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b <= a; ++b)
        add(spring.particles[a], spring.particles[b], weights[a] * weights[b] * hessian);
    }
  });
}

std::vector<std::pair<int, int>> ImplicitCloth::find_element_pairs() const {
  std::vector<std::pair<int, int>> pairs;
  if (model_->elements) pairs = ElementTerms::find_pairs(*model_->elements);
  for (const SeamSpring& seam : model_->topology->seams.springs) {
    for (const int k : {1, 2}) pairs.push_back(std::minmax(seam.particles[0], seam.particles[k]));
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

bool ImplicitCloth::is_beyond_limit(const std::vector<Vec3>& x) const {
  if (!model_->elements) return false;
  const double most = 1 + model_->elements->spring_limit.allowed();
  const auto is_beyond = [&](const Spring& s) {
    return is_limited(s) && (x[s.j] - x[s.i]).norm() > most * s.rest_length;
  };
  const std::vector<Spring>& springs = model_->topology->springs;
  return elements_.is_beyond_limit(x) || std::any_of(springs.begin(), springs.end(), is_beyond);
}

void ImplicitCloth::finish(const std::vector<Vec3>& x, bool is_pushed) {
  const std::size_t n = x.size();
  std::vector<Vec3>& v = velocity_;
  v.resize(n);
  for (std::size_t i = 0; i < n; ++i) v[i] = (x[i] - start_[i]) / step_;
  for (const int p : pinned()) v[p] = (x[p] - before_.x[p]) / whole_step_;
  const auto store = [&](const std::vector<Vec3>& from, Vec3Array& to, std::vector<Vec3>& precise) {
    to.resize(n);
    for (std::size_t i = 0; i < n; ++i) to.set(i, from[i]);
    if (keeps_ == Keeps::doubles) precise = from;
  };
  store(x, state_->x, state_->precise.x);
  store(v, state_->v, state_->precise.v);
  if (order_ == Order::first) return;
  before_.displacement.resize(n);
  for (std::size_t i = 0; i < n; ++i) before_.displacement[i] = x[i] - before_.x[i];
  store(before_.displacement, state_->history.displacement, state_->precise.displacement);
  store(before_.v, state_->history.velocity, state_->precise.velocity);
  state_->history.step = whole_step_;
  state_->history.had_contact = is_pushed;
}

}  // namespace weft::engine
