#pragma once
/// Survey of a step: which cloth patches may meet, and whether colliders are near, before any list is made.

#include <span>
#include <vector>

#include "weft/contact/cloth_clearance.h"
#include "weft/contact/step_bodies.h"
#include "weft/core/aligned.h"

namespace weft::engine {

class Survey {
 public:
  enum class Result {
    clear,      // nothing can meet
    few,        // only uncertain() may meet
    no_result,  // anything may meet
  };

  void reset(std::span<const ContactCloth> cloths);

  /// Whether to survey the step that begins: all cloths are grids, its start is needed for positions only, and no
  /// recent survey was without benefit.
  bool may_begin(const StepBodies& bodies, std::span<const ContactRule> rules);

  /// Surveys the straight motion to the prediction under inertia and `acceleration`; against colliders, to the
  /// ballistic prediction. `starts` (cloths) are offsets of particles; `pin_targets` as in
  /// ContactSystem::predict.
  Result survey_expected(const StepBodies& bodies, std::span<const Vec3Array> starts,
                         const Vec3& acceleration, std::span<const Vec3> pin_targets);

  /// Surveys the motion to the present positions. `is_predicted`: contacts are in the solve.
  Result survey_solved(const StepBodies& bodies, std::span<const Vec3Array> starts, bool is_predicted);

  /// The patch pairs that may meet, and the slack for lists of them, over the thickness of cloth [1].
  std::span<const ItemPair> uncertain() const { return uncertain_; }
  static constexpr double kSlackOfFew = 0.05;

 private:
  /// A box, and the distance from it within which colliders may matter [m].
  struct Region {
    Vec3 min, max;
    double reach;
  };

  void expect_ends(const StepBodies& bodies, const Vec3& acceleration, std::span<const Vec3> pin_targets);
  Result survey(const StepBodies& bodies, std::span<const Vec3Array> starts, double fall, bool is_predicted);
  Region surveyed_region(const StepBodies& bodies, double fall) const;
  bool are_shapes_far(const StepBodies& bodies, double fall) const;
  bool are_bodies_far(const StepBodies& bodies, double fall) const;

  ClothClearance clearance_;
  bool has_grids_ = false;  // every cloth is a grid
  int num_without_ = 0;     // number of upcoming steps without a survey

  // Work space.
  std::vector<Vec3Array> ends_;       // (cloths) predicted offsets
  AlignedFloats felt_;                // (particles of a cloth)
  std::vector<ClothMotion> motions_;  // (cloths)
  std::vector<ItemPair> uncertain_;
};

}  // namespace weft::engine
