#include "weft/laboratory.h"

#include <cmath>

#include "weft/core/logarithm.h"
#include "weft/error.h"

namespace weft {
namespace {

constexpr double kGramForce = 9.80665e-3;                           // [N]
constexpr double kPerCentimetre = 100;                              // [1/m]
constexpr double kDegree = 0.017453292519943295;                    // [rad]
constexpr double kFullTension = 500 * kGramForce * kPerCentimetre;  // of KES-F [N/m]
constexpr double kWearTension = 20 * kGramForce * kPerCentimetre;   // [N/m]

void require_positive(double value, const char* sheet, const char* what) {
  const bool is_positive = value > 0 && std::isfinite(value);
  if (!is_positive) throw InputError(std::string(sheet) + ": " + what + " must be above 0");
}

double cube(double x) { return x * x * x; }

/// Extension of T = T_max (ε/EMT)ⁿ under a tension [1].
double kes_extension(double full_extension, double linearity, double tension) {
  const double n = 2 / linearity - 1;
  return full_extension * engine::power(tension / kFullTension, 1 / n);
}

std::vector<StretchPoint> kes_curve(double full_extension, double linearity) {
  std::vector<StretchPoint> curve;
  for (const double share : {0.04, 0.1, 0.25, 0.5, 1.0}) {
    const double tension = share * kFullTension;
    curve.push_back({kes_extension(full_extension, linearity, tension), tension});
  }
  return curve;
}

void validate(const KesSheet& sheet) {
  require_positive(sheet.extension_warp, "KES-F sheet", "extension_warp (EMT)");
  require_positive(sheet.extension_weft, "KES-F sheet", "extension_weft (EMT)");
  for (const double lt : {sheet.linearity_warp, sheet.linearity_weft}) {
    const bool is_possible = lt >= 0.3 && lt <= 1;
    if (!is_possible) throw InputError("KES-F sheet: linearity (LT) must be from 0.3 to 1");
  }
}

}  // namespace

Fabric fabric_from(const KesSheet& sheet) {
  validate(sheet);
  const double warp = sheet.extension_warp / 100, weft = sheet.extension_weft / 100;
  constexpr double kBending = kGramForce / kPerCentimetre;  // 1 gf·cm²/cm [N·m]
  Fabric fabric;
  fabric.density = 0.01 * sheet.weight;
  fabric.thickness = 1e-3 * sheet.thickness;
  fabric.c11 = kWearTension / kes_extension(warp, sheet.linearity_warp, kWearTension);
  fabric.c22 = kWearTension / kes_extension(weft, sheet.linearity_weft, kWearTension);
  fabric.c12 = 0;
  fabric.g = kGramForce * kPerCentimetre / kDegree * sheet.shear;
  fabric.bend_warp = kBending * sheet.bend_warp;
  fabric.bend_weft = kBending * sheet.bend_weft;
  fabric.bend_bias = std::sqrt(fabric.bend_warp * fabric.bend_weft);
  fabric.bend_hysteresis_warp = kGramForce * sheet.hysteresis_warp;  // 1 gf·cm/cm = 1 gf
  fabric.bend_hysteresis_weft = kGramForce * sheet.hysteresis_weft;
  fabric.friction = sheet.friction;
  fabric.stretch_warp = kes_curve(warp, sheet.linearity_warp);
  fabric.stretch_weft = kes_curve(weft, sheet.linearity_weft);
  validate_fabric(fabric, "KES-F sheet");
  return fabric;
}

Fabric fabric_from(const FastSheet& sheet) {
  const double warp = sheet.extension_20_warp - sheet.extension_5_warp;
  const double weft = sheet.extension_20_weft - sheet.extension_5_weft;
  require_positive(warp, "FAST sheet", "extension_20_warp - extension_5_warp (E20-1 - E5-1)");
  require_positive(weft, "FAST sheet", "extension_20_weft - extension_5_weft (E20-2 - E5-2)");
  require_positive(sheet.bias_extension, "FAST sheet", "bias_extension (EB5)");
  Fabric fabric;
  fabric.density = 1e-3 * sheet.weight;
  fabric.thickness = 1e-3 * sheet.thickness;
  fabric.c11 = 14.7 / (warp / 100);
  fabric.c22 = 14.7 / (weft / 100);
  fabric.c12 = 0;
  fabric.g = 123 / sheet.bias_extension;
  fabric.bend_warp = 9.81e-12 * sheet.weight * cube(sheet.bending_length_warp);
  fabric.bend_weft = 9.81e-12 * sheet.weight * cube(sheet.bending_length_weft);
  fabric.bend_bias = std::sqrt(fabric.bend_warp * fabric.bend_weft);
  fabric.friction = sheet.friction;
  validate_fabric(fabric, "FAST sheet");
  return fabric;
}

Fabric fabric_from(const CloProperties& properties) {
  Fabric fabric;
  fabric.density = 1e-3 * properties.density;
  fabric.thickness = 1e-3 * properties.thickness;
  fabric.c11 = 1e-3 * properties.stretch_warp;
  fabric.c22 = 1e-3 * properties.stretch_weft;
  fabric.c12 = 0;
  fabric.g = 1e-3 * properties.shear;
  fabric.bend_warp = 1e-9 * properties.bend_warp;
  fabric.bend_weft = 1e-9 * properties.bend_weft;
  fabric.bend_bias = 1e-9 * properties.bend_bias;
  fabric.friction = properties.friction;
  validate_fabric(fabric, "CLO properties");
  return fabric;
}

}  // namespace weft
