#pragma once
/// Check of a step with contact or gas: whether it was short enough.
///
/// A step that is too long for an impact, or for cloth that is inflated, stretches single springs, crushes
/// triangles, or increases the energy. Each is measured relative to the start of the step, so that the check
/// does not depend on the fabric's softness. A fault's severity is its size over the allowed size; from 1 on
/// the step must be divided.

#include <optional>
#include <span>

#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"
#include "weft/report.h"

namespace weft::engine {

struct StepCheck {
  StepFault fault = StepFault::stretch;
  double severity = 0;            // of the worst fault; 0: none [1]
  double value = 0;               // value of that fault, see StepFault
  int cloth = -1, particle = -1;  // position of the fault; -1: none

  void include(const StepCheck& other) {
    if (other.severity > severity) *this = other;
  }
};

/// A cloth before and after a step.
struct CheckedCloth {
  const ClothModel& model;
  const ClothState &before, &after;
};

/// Check of all cloths; those without contact and gas are skipped. `is_driven`: pins, shapes, wind or
/// attachments may have done work, so the energy is not checked.
StepCheck check_step(std::span<const CheckedCloth> cloths, const Vec3& gravity, double step, bool is_driven);

}  // namespace weft::engine
