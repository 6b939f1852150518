#pragma once
/// Strips of fabric whose rest and motion have a closed formula: whatever the mesh and the step.

#include "lab/textile/specimen.h"

namespace weft::engine::lab {

/// A strip of 1 m × 0.25 m between two bars that are 0.8 m apart: a catenary, where bending and stretching
/// are small beside weight. It starts as an arc near it, at rest.
Specimen make_hammock(const Fabric& fabric, int cells, SpecimenMesh mesh);

/// How far the middle of the catenary hangs below its ends [m].
inline constexpr double kHammockSag = 0.8 * 0.331797;  // its length over its span is 1.25

/// How far the lowest point hangs below y = 0 [m].
double measure_sag(const Specimen& specimen);

/// The frequency of a chain's first mode: a strip of a metre, hung by its upper end, (j₀₁/4π) √(g/L) [1/s].
inline constexpr double kSwingFrequency = 0.59940;

/// The time of a swing of a strip of 1 m × 0.25 m, hung by its upper end, in its first mode, with `newton` at
/// a hundred iterations [s]. 0 if it does not swing.
double measure_swing_period(const Fabric& fabric, int cells, SpecimenMesh mesh, int steps_per_second = 240);

}  // namespace weft::engine::lab
