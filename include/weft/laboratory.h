#pragma once
/// Laboratory sheets of fabrics, in their printed units, converted to SI.
///
/// Values missing on a sheet: c12 = 0 (both systems pull wide strips, in which warp and weft do not
/// interact); bend_bias is the geometric mean of warp and weft (over the ten fabrics of Wang et al. 2011, the
/// measured bias is 0.77 to 1.36 times that, median 0.97); damping is Fabric's default.

#include "weft/fabric.h"

namespace weft {

/// Kawabata Evaluation System for Fabrics (KES-F), standard conditions: tension up to 500 gf/cm, shear to 8°.
/// S. Kawabata, The Standardization and Analysis of Hand Evaluation, 2nd edition, 1980.
struct KesSheet {
  double weight = 0;                    // W [mg/cm²]
  double thickness = 0;                 // T0, under 0.5 gf/cm² [mm]
  double extension_warp = 0;            // EMT, at 500 gf/cm [%]
  double extension_weft = 0;            // [%]
  double linearity_warp = 1;            // LT = WT / (½ · 500 gf/cm · EMT), from 0.3 to 1 [1]
  double linearity_weft = 1;            // [1]
  double shear = 0;                     // G [gf/(cm·degree)]
  double bend_warp = 0;                 // B [gf·cm²/cm]
  double bend_weft = 0;                 // [gf·cm²/cm]
  double hysteresis_warp = 0;           // 2HB, at a curvature of 1/cm [gf·cm/cm]
  double hysteresis_weft = 0;           // [gf·cm/cm]
  double friction = Fabric().friction;  // MIU, against the steel feeler [1]
};

/// density = 0.01 W; bending = 9.80665e-5 B; its hysteresis = 9.80665e-3 2HB; g = 56.19 G (1 gf/cm = 0.980665 N/m,
/// 1° = π/180 rad).
///
/// Stretching stiffens: the curve is taken as T = T_max (ε/EMT)ⁿ, whose linearity is LT = 2/(n + 1). c11 and
/// c22 are the secants at 20 gf/cm = 19.6 N/m, about the load of cloth under its own weight and in wear (FAST
/// also measures there). They equal T_max/EMT where LT = 1. Five points of the curve go to stretch_warp and
/// stretch_weft.
///
/// Throws InputError for numbers out of range, or if the fabric is invalid.
WEFT_API Fabric fabric_from(const KesSheet& sheet);

/// Fabric Assurance by Simple Testing (SiroFAST), extensions under 5, 20 and 100 gf/cm.
/// A. De Boos and D. Tester, SiroFAST: A System for Fabric Objective Measurement, CSIRO report WT92.02, 1994.
struct FastSheet {
  double weight = 0;                    // W [g/m²]
  double thickness = 0;                 // T2, under 2 gf/cm² [mm]
  double bending_length_warp = 0;       // C-1, by the 41.5° cantilever [mm]
  double bending_length_weft = 0;       // C-2 [mm]
  double extension_5_warp = 0;          // E5-1 [%]
  double extension_20_warp = 0;         // E20-1 [%]
  double extension_5_weft = 0;          // E5-2 [%]
  double extension_20_weft = 0;         // E20-2 [%]
  double bias_extension = 0;            // EB5, along the bias under 5 gf/cm [%]
  double friction = Fabric().friction;  // not on the sheet [1]
};

/// bending = 9.81e-12 W C³ (FAST's own B = 9.81e-6 W C³ µN·m); g = 123/EB5 (FAST's own); c11 and c22 =
/// 14.7 N/m over the extension between 5 and 20 gf/cm, as in FAST's formability.
/// Throws InputError for numbers out of range, or if the fabric is invalid.
WEFT_API Fabric fabric_from(const FastSheet& sheet);

/// Physical properties of CLO and Marvelous Designer, in the units of their property editor when it does not
/// show 0 to 99. Gram, millimetre and second: 1 g/s² = 1e-3 N/m, 1 g·mm²/s² = 1e-9 N·m.
struct CloProperties {
  double density = 0;                   // [g/m²]
  double thickness = 0;                 // [mm]
  double stretch_warp = 0;              // [g/s²]
  double stretch_weft = 0;              // [g/s²]
  double shear = 0;                     // [g/s²]
  double bend_warp = 0;                 // [g·mm²/s²]
  double bend_weft = 0;                 // [g·mm²/s²]
  double bend_bias = 0;                 // [g·mm²/s²]
  double friction = Fabric().friction;  // [1]
};

/// Throws InputError if the fabric is invalid. Buckling ratio and stiffness have no counterpart.
WEFT_API Fabric fabric_from(const CloProperties& properties);

}  // namespace weft
