#include "weft/contact/survey.h"

#include <algorithm>
#include <limits>

#include "weft/contact/shape_clearance.h"
#include "weft/core/simd.h"
#include "weft/geometry/shape_distance.h"

namespace weft::engine {
namespace {

/// Distance that features outside the search keep, over the contact gap [1]. 1.25 is more than the solve
/// counts as near, and more than the deviation from the prediction at which contact projection is a no-op.
/// The rest is twice the slack of lists of few patches.
constexpr double kRoom = 1.25 + 2 * Survey::kSlackOfFew;

/// Limit on uncertain pairs, over the number of patches, for searching only these [1].
constexpr double kFew = 1;

/// After a survey without benefit, this many steps skip it.
constexpr int kStepsWithout = 15;

/// Additional distance from colliders [m].
constexpr double kRoomFromColliders = 1e-4;

/// One component of the predicted end positions: x + h v + gain · share, where `share` is the fraction of the
/// acceleration that acted in the last step.
WEFT_ALWAYS_INLINE void predict_ballistic_body(const float* x, const float* v, const float* share, float step,
                                               float gain, int count, float* ends) {
  for (int i = 0; i < count; ++i) ends[i] = x[i] + step * v[i] + gain * share[i];
}
WEFT_MULTIVERSION(predict_ballistic,
                  (const float* x, const float* v, const float* share, float step, float gain, int count,
                   float* ends),
                  (x, v, share, step, gain, count, ends))

/// The shares of the acceleration that the last step added to velocities: `per_gain` is the acceleration over
/// its squared size and over that step.
WEFT_ALWAYS_INLINE void find_felt_body(const Vec3Array& v, const Vec3Array& before, const float* per_gain,
                                       int count, float* share) {
  const float *x = v.x(), *y = v.y(), *z = v.z(), *bx = before.x(), *by = before.y(), *bz = before.z();
  for (int i = 0; i < count; ++i) {
    const float gained =
        (x[i] - bx[i]) * per_gain[0] + (y[i] - by[i]) * per_gain[1] + (z[i] - bz[i]) * per_gain[2];
    share[i] = std::min(std::max(gained, 0.0f), 1.0f);
  }
}
WEFT_MULTIVERSION(find_felt,
                  (const Vec3Array& v, const Vec3Array& before, const float* per_gain, int count,
                   float* share),
                  (v, before, per_gain, count, share))

}  // namespace

void Survey::reset(std::span<const ContactCloth> cloths) {
  std::vector<Grid> grids;
  for (const ContactCloth& cloth : cloths) {
    if (cloth.model->topology->grid) grids.push_back(*cloth.model->topology->grid);
  }
  has_grids_ = grids.size() == cloths.size();
  clearance_.reset(grids);
  ends_.resize(cloths.size());
  motions_.resize(cloths.size());
}

bool Survey::may_begin(const StepBodies& bodies, std::span<const ContactRule> rules) {
  if (num_without_ > 0) {
    --num_without_;
    return false;
  }
  const auto has_static = [](const MovingShape& shape) { return shape.collider->static_friction > 0; };
  const auto sets_static = [](const ContactRule& rule) { return rule.static_friction.value_or(0) > 0; };
  const auto has_caught = [](const ContactCloth& cloth) { return !cloth.state->caught.empty(); };
  return has_grids_ && std::none_of(bodies.cloths.begin(), bodies.cloths.end(), has_caught) &&
         std::none_of(bodies.shapes.begin(), bodies.shapes.end(), has_static) &&
         std::none_of(rules.begin(), rules.end(), sets_static);
}

/// Ends as ContactSystem::expect_motion() predicts them, but in floats.
void Survey::expect_ends(const StepBodies& bodies, const Vec3& acceleration,
                         std::span<const Vec3> pin_targets) {
  const double h = bodies.step, size_sq = acceleration.squaredNorm();
  std::size_t pin = 0;
  for (int c = 0; c < bodies.num_cloths(); ++c) {
    const ClothState& state = *bodies.cloths[c].state;
    const int count = static_cast<int>(state.x.size());
    Vec3Array& ends = ends_[c];
    ends.resize(count);
    felt_.assign(count, 1.0f);
    if (state.history.step > 0 && size_sq > 0) {
      const Vec3 per_gain = acceleration / (size_sq * state.history.step);
      const float factors[] = {static_cast<float>(per_gain.x()), static_cast<float>(per_gain.y()),
                               static_cast<float>(per_gain.z())};
      find_felt(state.v, state.history.velocity, factors, count, felt_.data());
    }
    const float *const x[] = {state.x.x(), state.x.y(), state.x.z()}, *const v[] = {state.v.x(), state.v.y(),
                                                                                    state.v.z()};
    float* const end[] = {ends.x(), ends.y(), ends.z()};
    for (int k = 0; k < 3; ++k)
      predict_ballistic(x[k], v[k], felt_.data(), static_cast<float>(h),
                        static_cast<float>(h * h * acceleration[k]), count, end[k]);
    const std::vector<char>& is_pinned = *bodies.cloths[c].is_pinned;
    for (int i = 0; i < count && pin < pin_targets.size(); ++i) {
      if (is_pinned[i]) ends.set(i, pin_targets[pin++] - state.origin);
    }
  }
}

Survey::Result Survey::survey_expected(const StepBodies& bodies, std::span<const Vec3Array> starts,
                                       const Vec3& acceleration, std::span<const Vec3> pin_targets) {
  expect_ends(bodies, acceleration, pin_targets);
  for (int c = 0; c < bodies.num_cloths(); ++c) motions_[c].end = &ends_[c];
  return survey(bodies, starts, bodies.step * bodies.step * acceleration.norm(), true);
}

Survey::Result Survey::survey_solved(const StepBodies& bodies, std::span<const Vec3Array> starts,
                                     bool is_predicted) {
  for (int c = 0; c < bodies.num_cloths(); ++c) motions_[c].end = &bodies.cloths[c].state->x;
  return survey(bodies, starts, 0, is_predicted);
}

/// `fall`: how much farther cloth may move [m].
Survey::Result Survey::survey(const StepBodies& bodies, std::span<const Vec3Array> starts, double fall,
                              bool is_predicted) {
  for (int c = 0; c < bodies.num_cloths(); ++c) {
    motions_[c].start = &starts[c];
    motions_[c].origin = bodies.cloths[c].state->origin;
    motions_[c].thickness = bodies.cloths[c].model->material.thickness;
  }
  const auto most = static_cast<std::size_t>(kFew * clearance_.num_patches());
  const bool is_known =
      clearance_.find_uncertain(motions_, kRoom, most, uncertain_) && are_bodies_far(bodies, fall);
  if (is_known && uncertain_.empty() && are_shapes_far(bodies, fall)) return Result::clear;
  // With many short steps, persistent lists are faster.
  if (is_known && is_predicted) return Result::few;
  num_without_ = kStepsWithout;
  return Result::no_result;
}

/// Bounds of cloth during the surveyed step, enlarged by `fall`.
Survey::Region Survey::surveyed_region(const StepBodies& bodies, double fall) const {
  const SweptBox& bounds = clearance_.bounds();
  const Float4 low = bounds.min + bounds.way_min.cwiseMin(Float4::Zero()),
               high = bounds.max + bounds.way_max.cwiseMax(Float4::Zero());
  const Vec3 origin = bodies.cloths[0].state->origin, margin = Vec3::Constant(fall);
  const double way = bounds.way_min.cwiseAbs().cwiseMax(bounds.way_max.cwiseAbs()).norm() + fall;
  return {origin + low.xyz().cast<double>() - margin, origin + high.xyz().cast<double>() + margin,
          2 * bodies.thickest + way + kRoomFromColliders};
}

bool Survey::are_shapes_far(const StepBodies& bodies, double fall) const {
  if (!bodies.has_plain_shapes()) return true;
  const Region region = surveyed_region(bodies, fall);
  const double reach = region.reach + bodies.most_lift();
  return std::all_of(bodies.shapes.begin(), bodies.shapes.end(), [&](const MovingShape& shape) {
    return shape.is_mesh() || least_distance(shape, region.min, region.max) > reach;
  });
}

bool Survey::are_bodies_far(const StepBodies& bodies, double fall) const {
  const std::vector<ColliderMesh>& meshes = bodies.numbering.bodies;
  if (meshes.empty()) return true;
  const Region region = surveyed_region(bodies, fall);
  return std::all_of(meshes.begin(), meshes.end(), [&](const ColliderMesh& body) {
    const MovingShape& shape = bodies.shapes[body.collider];
    const auto [before_min, before_max] = body.bounds_at(std::get<MeshShape>(shape.before));
    const auto [after_min, after_max] = body.bounds_at(std::get<MeshShape>(shape.after));
    return boxes_distance(before_min.cwiseMin(after_min), before_max.cwiseMax(after_max), region.min,
                          region.max) > region.reach;
  });
}

}  // namespace weft::engine
