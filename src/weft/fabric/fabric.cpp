#include "weft/fabric.h"

#include <charconv>
#include <cmath>

#include "weft/error.h"
#include "weft/fabric/fabric_ranges.h"
#include "weft/fabric/membrane_law.h"

namespace weft {
namespace {

constexpr double kDensityOfLead = 11340;  // [kg/m³]

std::string text(double number) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, number, std::chars_format::general, 4).ptr};
}

/// Collects mistakes, at most one per field.
class FabricChecker {
 public:
  void require(bool is_right, const char* field, double value, const std::string& rule) {
    if (!is_right || !std::isfinite(value)) refuse(field, "must be " + rule + ", is " + text(value));
  }

  void require_range(const engine::FabricRange& range, const char* field, double value) {
    require(range.contains(value), field, value, std::string(range.words));
  }

  void refuse(const std::string& field, const std::string& reason) {
    for (const FabricMistake& m : mistakes) {
      if (m.field == field) return;
    }
    mistakes.push_back({field, reason});
  }

  bool has_none() const { return mistakes.empty(); }

  std::vector<FabricMistake> mistakes;
};

void check_ranges(const Fabric& f, FabricChecker& checker) {
  checker.require(f.density > 0, "density", f.density, "above 0 kg/m²");
  checker.require(f.c11 > 0, "c11", f.c11, "above 0 N/m");
  checker.require(f.c22 > 0, "c22", f.c22, "above 0 N/m");
  checker.require(true, "c12", f.c12, "a finite number in N/m");
  checker.require(f.g > 0, "g", f.g, "above 0 N/m");
  checker.require(f.bend_warp >= 0, "bend_warp", f.bend_warp, "0 N·m or above");
  checker.require(f.bend_weft >= 0, "bend_weft", f.bend_weft, "0 N·m or above");
  checker.require(f.bend_bias >= 0, "bend_bias", f.bend_bias, "0 N·m or above");
  checker.require(f.bend_hysteresis_warp >= 0, "bend_hysteresis_warp", f.bend_hysteresis_warp,
                  "0 N or above");
  checker.require(f.bend_hysteresis_weft >= 0, "bend_hysteresis_weft", f.bend_hysteresis_weft,
                  "0 N or above");
  checker.require(f.bend_set >= 0, "bend_set", f.bend_set, "0 (none) or above, in 1/m");
  checker.require_range(engine::kDampingRange, "damping", f.damping);
  checker.require_range(engine::kThicknessRange, "thickness", f.thickness);
  checker.require_range(engine::kFrictionRange, "friction", f.friction);
  checker.require_range(engine::kStrainLimitRange, "strain_limit", f.strain_limit);
  checker.require(f.strength >= 0, "strength", f.strength, "0 N/m (never tears) or above");
}

/// Relations between the numbers.
void check_relations(const Fabric& f, FabricChecker& checker) {
  if (f.c12 * f.c12 >= f.c11 * f.c22) {
    checker.refuse(
        "c12", "must be less than √(c11 c22) = " + text(std::sqrt(f.c11 * f.c22)) + " N/m in magnitude, is " +
                   text(f.c12) +
                   ": the membrane is not positive definite, so some stretching would release energy");
  }
  const double roots = std::sqrt(f.bend_warp) - std::sqrt(f.bend_weft);
  const double least_bias = roots * roots / 4;
  if (f.bend_bias < least_bias) {
    checker.refuse("bend_bias", "must be at least (√bend_warp − √bend_weft)²/4 = " + text(least_bias) +
                                    " N·m, is " + text(f.bend_bias) + ": some bending would release energy");
  }
  if (f.density > kDensityOfLead * f.thickness) {
    checker.refuse("density", "must be at most " + text(kDensityOfLead * f.thickness) + " kg/m², is " +
                                  text(f.density) + ": heavier than sheet lead of the fabric's thickness, " +
                                  text(f.thickness) + " m");
  }
}

void check_curve(const std::vector<StretchPoint>& curve, const char* field, FabricChecker& checker) {
  StretchPoint last;
  for (const StretchPoint& point : curve) {
    const bool rises = point.strain > last.strain && point.tension > last.tension &&
                       std::isfinite(point.strain) && std::isfinite(point.tension);
    if (!rises) {
      return checker.refuse(field, "must increase from the origin, does not at strain " + text(point.strain));
    }
    last = point;
  }
  if (curve.size() > kMaxStretchPoints)
    checker.refuse(field, "must have at most " + std::to_string(kMaxStretchPoints) + " points, has " +
                              std::to_string(curve.size()));
}

/// Smallest slope of the stress along a thread [N/m].
double least_slope(const std::vector<StretchPoint>& curve, double linear) {
  double slope = linear, least = linear;
  for (const engine::StretchKink& kink : engine::make_stretch_kinks(curve, linear)) {
    slope += kink.slope;
    least = std::min(least, slope);
  }
  return least;
}

void check_slopes(const Fabric& f, FabricChecker& checker) {
  const double warp = least_slope(f.stretch_warp, f.c11), weft = least_slope(f.stretch_weft, f.c22);
  const char* field = warp / f.c11 < weft / f.c22 ? "stretch_warp" : "stretch_weft";
  if (warp > 0 && weft > 0 && warp * weft > f.c12 * f.c12) return;
  checker.refuse(field,
                 "is too flat: tension over stretch must increase everywhere, and the product of the minimum "
                 "slopes of warp and weft, " +
                     text(warp) + " and " + text(weft) + " N/m, must exceed c12²");
}

}  // namespace

std::vector<FabricMistake> find_mistakes(const Fabric& fabric) {
  FabricChecker checker;
  check_ranges(fabric, checker);
  if (checker.has_none()) check_relations(fabric, checker);
  check_curve(fabric.stretch_warp, "stretch_warp", checker);
  check_curve(fabric.stretch_weft, "stretch_weft", checker);
  if (checker.has_none()) check_slopes(fabric, checker);
  return checker.mistakes;
}

void validate_fabric(const Fabric& fabric, const std::string& name) {
  std::string message;
  for (const FabricMistake& m : find_mistakes(fabric)) {
    message += (message.empty() ? "fabric \"" + name + "\": " : "; ") + m.field + " " + m.reason;
  }
  if (!message.empty()) throw InputError(message);
}

double bending_rigidity(const Fabric& fabric, double cos_psi, double sin_psi) {
  const double cc = cos_psi * cos_psi, ss = sin_psi * sin_psi;
  const double twist = 4 * fabric.bend_bias - fabric.bend_warp - fabric.bend_weft;
  return fabric.bend_warp * cc * cc + fabric.bend_weft * ss * ss + twist * cc * ss;
}

}  // namespace weft
