#pragma once
/// Simulations of the standard tests of textile laboratories, with the results that a laboratory reports.

#include <string>
#include <vector>

#include "lab/report/report.h"
#include "lab/textile/specimen.h"

namespace weft::engine::lab {

/// Direction in which a strip is cut.
enum class StripDirection { warp, weft, bias };

/// The cantilever test (ISO 9073-7, Peirce 1930): a horizontal strip bends under its own weight. The overhang
/// is chosen for an expected chord angle of 41.5°, where the bending length is half the overhang.
///
///     clamp ▬▬▬──.           h_over_w          drop over horizontal distance of the tip [1]
///                  `.  H     chord_angle       atan(H/W) [degrees]
///              W      \      bending_length    L/2 at 41.5°, else times Peirce's (cos(θ/2)/tan θ)^⅓ over
///                                              that of 41.5° [m]
///                            bending_rigidity  ρ g (bending length)³ [N·m]
///                            overhang          L [m]
///
/// The elastica has H/W = 0.88473 at this angle. Specimen: 25 cells along, 4 across.
Findings test_cantilever(const Fabric& fabric, const SpecimenSettings& settings, StripDirection direction);

/// The pure bending test of KES-F (Kawabata 1980): a strip of 1 cm between two clamps that hold it on a circular arc,
/// slowly bent to 2.5/cm, to −2.5/cm and to 2.5/cm again.
///
///     bending_rigidity  B, the slope of the moment from 0.5 to 1.5/cm, mean of both sides [N·m]
///     hysteresis        2HB, the distance of the branches at 1/cm, mean of both sides [N]
///
/// Moments are those of the forces on a clamp. Specimen: 20 cells along, 8 across. Picture: the loop as a plot.
Findings test_bending(const Fabric& fabric, const SpecimenSettings& settings, StripDirection direction);

/// Biaxial tensile test: stretching along warp and along weft by 0.1 %, all sides clamped. c11, c22, c12 from
/// the forces at the clamps [N/m]. Specimen: 10 cm, 10 × 10 cells.
Findings test_tensile(const Fabric& fabric, const SpecimenSettings& settings);

/// Simple shear by 0.001 rad between clamps: `g` from the force along them [N/m]. Specimen as above.
Findings test_shear(const Fabric& fabric, const SpecimenSettings& settings);

/// Lateral buckling: a strip clamped at one end with its width vertical, under increasing gravity until it
/// tips over sideways.
///
///     critical_load    Γ = ρ g L³/B at tipping, with B the rigidity along warp [1]
///     critical_length  length of a strip that tips under the earth's gravity [m]
///
/// Theory for a thin isotropic strip with Poisson's ratio 0: Γ = 12.85 √2 = 18.2. Specimen: 25 cells along, 2
/// across; bisection to 1 %. Grids give 9 % more than theory, random meshes 17 % less.
Findings test_buckling(const Fabric& fabric, const SpecimenSettings& settings);

/// The drape test (ISO 9073-9, Cusick 1968): a disc of 30 cm held between plates of 18 cm.
///
///     drape_coefficient         shadow of the hanging part over that of a stiff ring [%]
///     drape_coefficient_spread  standard deviation over five specimens with initial creases of 0.2 mm [%]
///     drape_nodes               mean number of folds [1]
///
/// Under a fabric with hysteresis of bending a support is lowered in 3 s, as the standard says; others are let go.
/// Specimen: 30 rings, with self-contact; `settings.mesh` = `random` moves its vertices.
Findings test_drape(const Fabric& fabric, const SpecimenSettings& settings, int threads);

}  // namespace weft::engine::lab
