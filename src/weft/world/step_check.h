#pragma once
/// Whether a step of cloth in contact was short enough.
///
/// A step that is too long for an impact stretches single springs, crushes triangles, or comes out with more
/// energy than it went in with. Each is measured against what it was when the step began, so that no fabric
/// is judged by its softness: a fault's severity is its size over what a step may do, and from 1 on the step
/// is to be divided.

#include <optional>
#include <span>

#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"
#include "weft/report.h"

namespace weft::engine {

struct StepCheck {
  StepFault fault = StepFault::stretch;
  double severity = 0;            // of the worst fault; 0: none [1]
  double value = 0;               // of that fault, as above
  int cloth = -1, particle = -1;  // where; -1: nowhere in particular

  void include(const StepCheck& other) {
    if (other.severity > severity) *this = other;
  }
};

/// A cloth before and after a step.
struct CheckedCloth {
  const ClothModel& model;
  const ClothState &before, &after;
};

/// Of all cloths; those that touch nothing are not looked at. `is_driven`: pins, shapes, wind or hands may
/// have done work, so that energy tells nothing.
StepCheck check_step(std::span<const CheckedCloth> cloths, const Vec3& gravity, double step, bool is_driven);

}  // namespace weft::engine
