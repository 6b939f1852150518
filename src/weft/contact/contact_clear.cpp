/// ContactSystem's survey of a step: which cloth patches may meet, and whether colliders are near.

#include <algorithm>
#include <limits>

#include "weft/contact/contact_system.h"
#include "weft/core/simd.h"
#include "weft/geometry/shape_distance.h"

namespace weft::engine {
namespace {

/// Distance that features outside the search keep, over the contact gap [1]. 1.25 is more than the solve
/// counts as near, and more than the deviation from the prediction at which contact projection is a no-op.
/// The rest is twice the slack of lists of few patches.
constexpr double kSlackOfFew = 0.05, kRoom = 1.25 + 2 * kSlackOfFew;

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

/// Whether to survey: all cloths are grids, the step's start is needed for positions only, and no recent
/// survey was without benefit.
bool ContactSystem::may_survey() {
  if (num_without_ > 0) {
    --num_without_;
    return false;
  }
  const auto has_static = [](const MovingShape& shape) { return shape.collider->static_friction > 0; };
  const auto sets_static = [](const ContactRule& rule) { return rule.static_friction.value_or(0) > 0; };
  const auto has_caught = [](const ContactCloth& cloth) { return !cloth.state->caught.empty(); };
  return has_grids_ && std::none_of(cloths_.begin(), cloths_.end(), has_caught) &&
         std::none_of(shapes_.begin(), shapes_.end(), has_static) &&
         std::none_of(step_.rules.begin(), step_.rules.end(), sets_static);
}

/// As expect_motion(), but in floats.
void ContactSystem::expect_ends(const Vec3& acceleration, std::span<const Vec3> pin_targets) {
  const double h = step_.step, size_sq = acceleration.squaredNorm();
  std::size_t pin = 0;
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    const ClothState& state = *cloths_[c].state;
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
    const std::vector<char>& is_pinned = *cloths_[c].is_pinned;
    for (int i = 0; i < count && pin < pin_targets.size(); ++i) {
      if (is_pinned[i]) ends.set(i, pin_targets[pin++] - state.origin);
    }
  }
}

/// Surveys the straight motion to the prediction under inertia and `acceleration`; against colliders, to the
/// ballistic prediction.
void ContactSystem::survey_expected(const Vec3& acceleration, std::span<const Vec3> pin_targets) {
  expect_ends(acceleration, pin_targets);
  for (std::size_t c = 0; c < cloths_.size(); ++c) motions_[c].end = &ends_[c];
  survey(step_.step * step_.step * acceleration.norm());
}

/// Surveys the motion to the present positions.
void ContactSystem::survey_solved() {
  for (std::size_t c = 0; c < cloths_.size(); ++c) motions_[c].end = &cloths_[c].state->x;
  survey(0);
}

/// `fall`: how much farther cloth may move [m].
void ContactSystem::survey(double fall) {
  const WorkScope scope(step_.clock, &WorkTimes::lists);
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    motions_[c].start = &starts_[c];
    motions_[c].origin = cloths_[c].state->origin;
    motions_[c].thickness = cloths_[c].model->material.thickness;
  }
  const auto most = static_cast<std::size_t>(kFew * cloth_clearance_.num_patches());
  const bool is_known =
      cloth_clearance_.find_uncertain(motions_, kRoom, most, uncertain_) && are_bodies_far(fall);
  is_clear_ = is_known && uncertain_.empty() && are_shapes_far(fall);
  // With many short steps, persistent lists are faster.
  is_surveyed_ = is_clear_ || (is_known && is_predicted_);
  if (!is_surveyed_) num_without_ = kStepsWithout;
}

/// Updates the lists for motion_, which the last survey covered.
void ContactSystem::update_lists(JobSystem& jobs) {
  if (is_surveyed_)
    proximity_.update_among(motion_, uncertain_, kSlackOfFew * 2 * thinnest_, jobs);
  else
    proximity_.update(motion_, jobs);
}

/// Bounds of cloth during the surveyed step, enlarged by `fall`.
ContactSystem::Region ContactSystem::surveyed_region(double fall) const {
  const SweptBox& bounds = cloth_clearance_.bounds();
  const Float4 low = bounds.min + bounds.way_min.cwiseMin(0.0f),
               high = bounds.max + bounds.way_max.cwiseMax(0.0f);
  const Vec3 origin = cloths_[0].state->origin, margin = Vec3::Constant(fall);
  const double way = bounds.way_min.cwiseAbs().cwiseMax(bounds.way_max.cwiseAbs()).norm() + fall;
  return {origin + low.head<3>().cast<double>() - margin, origin + high.head<3>().cast<double>() + margin,
          2 * thickest_ + way + kRoomFromColliders};
}

bool ContactSystem::are_shapes_far(double fall) const {
  if (!has_plain_shapes()) return true;
  const Region region = surveyed_region(fall);
  return std::all_of(shapes_.begin(), shapes_.end(), [&](const MovingShape& shape) {
    return shape.is_mesh() || least_distance(shape, region.min, region.max) > region.reach;
  });
}

bool ContactSystem::are_bodies_far(double fall) const {
  if (bodies_.empty()) return true;
  const Region region = surveyed_region(fall);
  return std::all_of(bodies_.begin(), bodies_.end(), [&](const Body& body) {
    const MovingShape& shape = shapes_[body.collider];
    const auto [before_min, before_max] = body.bounds_at(std::get<MeshShape>(shape.before));
    const auto [after_min, after_max] = body.bounds_at(std::get<MeshShape>(shape.after));
    return boxes_distance(before_min.cwiseMin(after_min), before_max.cwiseMax(after_max), region.min,
                          region.max) > region.reach;
  });
}

/// Bounds of a static mesh; infinite for a deforming one.
std::pair<Vec3, Vec3> ContactSystem::Body::bounds_at(const MeshShape& shape) const {
  const Vec3 middle = shape.rotation * (0.5 * (min + max)) + shape.translation;
  Vec3 half = shape.rotation.cwiseAbs() * (0.5 * (max - min));
  if (shape.source) half.setConstant(std::numeric_limits<double>::infinity());
  return {middle - half, middle + half};
}

}  // namespace weft::engine
