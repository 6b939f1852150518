#pragma once
/// The standard tests of textile laboratories, simulated: what a laboratory would print for a fabric.

#include <string>
#include <vector>

#include "lab/textile/specimen.h"
#include "lab/report/report.h"

namespace weft::engine::lab {

/// Which way a strip is cut.
enum class StripDirection { warp, weft, bias };

/// The cantilever test (ISO 9073-7, Peirce 1930): a strip reaches out horizontally and sinks under its own
/// weight. The overhang is that at which its chord should sink by 41.5°, where bending length is half of it.
///
///     clamp ▬▬▬──.           h_over_w          sinking over reach of the tip [1]
///                  `.  H     chord_angle       atan(H/W) [degrees]
///              W      \      bending_length    L/2 at 41.5°, else times Peirce's (cos(θ/2)/tan θ)^⅓ over
///                                             that of 41.5° [m]
///                            bending_rigidity  ρ g (bending length)³ [N·m]
///                            overhang          L [m]
///
/// The elastica has H/W = 0.88473 there. Specimen: 25 cells along, 4 across.
Findings test_cantilever(const Fabric& fabric, const SpecimenSettings& settings,
                             StripDirection direction);

/// Stretching along warp and along weft by 0.1 %, all sides clamped and drawn apart: c11, c22, c12 from the
/// forces at the clamps [N/m]. Specimen: 10 cm, 10 × 10 cells.
Findings test_tensile(const Fabric& fabric, const SpecimenSettings& settings);

/// Simple shear by 0.001 rad between clamps: `g` from the force along them [N/m]. Specimen as above.
Findings test_shear(const Fabric& fabric, const SpecimenSettings& settings);

/// Lateral buckling: a strip clamped at one end with its width upright, under a gravity that grows until it
/// tips over sideways.
///
///     critical_load    Γ = ρ g L³/B at which it does, B the rigidity along warp [1]
///     critical_length  a strip so long does under the earth's gravity [m]
///
/// A thin strip whose rigidity is the same in all directions (Poisson's ratio 0): Γ = 12.85 √2 = 18.2.
/// Specimen: 25 cells along, 2 across, found by halving to 1 %; grids show 9 % more than theory, random
/// meshes 17 % less.
Findings test_buckling(const Fabric& fabric, const SpecimenSettings& settings);

/// The drape test (ISO 9073-9, Cusick 1968): a disc of 30 cm held between plates of 18 cm.
///
///     drape_coefficient         shadow of what hangs, over that of the ring it would be if it were stiff [%]
///     drape_coefficient_spread  standard deviation over five specimens with creases of 0.2 mm at first [%]
///     drape_nodes               folds, their mean [1]
///
/// Specimen: 30 rings, with self-contact; `settings.mesh` moves its vertices for `random`.
Findings test_drape(const Fabric& fabric, const SpecimenSettings& settings, int threads);

}  // namespace weft::engine::lab
