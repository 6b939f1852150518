#pragma once
/// Strips of fabric with an analytic rest shape and motion, independent of mesh and step.

#include "lab/textile/specimen.h"

namespace weft::engine::lab {

/// A strip of 1 m × 0.25 m between two bars that are 0.8 m apart. Its rest shape is a catenary if bending and
/// stretching are small compared with weight. It starts at rest, as an arc near the catenary.
Specimen make_hammock(const Fabric& fabric, int cells, SpecimenMesh mesh);

/// Sag of the catenary [m].
inline constexpr double kHammockSag = 0.8 * 0.331797;  // length over span: 1.25

/// Depth of the lowest point below y = 0 [m].
double measure_sag(const Specimen& specimen);

/// Frequency of a chain's first mode, for a strip of a metre, hung by its upper end: (j₀₁/4π) √(g/L) [1/s].
inline constexpr double kSwingFrequency = 0.59940;

/// Period of the first mode of a strip of 1 m × 0.25 m, hung by its upper end, with `newton` at a hundred
/// iterations [s]. 0 if it does not swing.
double measure_swing_period(const Fabric& fabric, int cells, SpecimenMesh mesh, int steps_per_second = 240);

}  // namespace weft::engine::lab
