#pragma once
/// Fabric as a physical thing, in SI units: properties of the cloth, not of the mesh that stands for it.
///
/// Stretching is a linear law between Green strain and tension per width in the frame of warp (1) and weft
/// (2), both in the plane of the cloth:
///
///     | tension 1 |   | C11 C12  0 | | strain 1      |      energy per area ½ eᵀ C e [J/m²]
///     | tension 2 | = | C12 C22  0 | | strain 2      |
///     | shear     |   |  0   0   G | | shear angle γ |      γ: by how much warp and weft leave 90° [rad]
///
/// Bending about any axis costs ½ D(ψ) κ² per area, κ the curvature [1/m] of a cylinder rolled in the
/// direction ψ from warp (see bending_rigidity()).

#include <string>
#include <string_view>
#include <vector>

#include "weft/export.h"

namespace weft {

inline constexpr int kMostStretchPoints = 8;

/// A point of a measured stretch curve.
struct StretchPoint {
  double strain = 0;   // extension over rest length, > 0 [1]
  double tension = 0;  // force per width, > 0 [N/m]
};

/// The defaults are those of the preset `cotton_shirting`, where their sources are.
struct Fabric {
  /// Mass per area. Real: 0.03 (chiffon) to 0.5 (coating). More: hangs straighter, swings slower in wind.
  /// > 0, and no heavier than sheet lead as thick as the fabric [kg/m²].
  double density = 0.12;

  /// Stiffness of stretching along warp. Real: 25 (jumper) to 10000 (canvas). More: sags and stretches less.
  /// > 0 [N/m].
  double c11 = 2800;

  /// Of stretching along weft: as c11 [N/m].
  double c22 = 1400;

  /// How much stretching along one draws in along the other. c12² < c11 c22 keeps the matrix positive
  /// definite. More: narrows more when pulled; 0 for most woven fabric. May be negative [N/m].
  double c12 = 0;

  /// Stiffness of shearing, force per width and radian. Real: 14 (silk) to 120 (denim), leather 700. Less:
  /// drapes softer and takes double curvature. > 0 [N/m].
  double g = 45;

  /// Rigidity of bending along warp: a cylinder around weft threads. Real: 1e-6 (silk) to 1e-4 (coating).
  /// More: larger, fewer folds. >= 0 [N·m].
  double bend_warp = 7e-6;

  /// Along weft: as bend_warp [N·m].
  double bend_weft = 6e-6;

  /// Along the bias, at 45°. At least (√bend_warp − √bend_weft)²/4: below, some bending would release energy
  /// [N·m].
  double bend_bias = 6e-6;

  /// Time constant τ of internal damping (Kelvin–Voigt): every elastic stress σ(e) comes with a viscous
  /// τ dσ/dt, in stretching, shearing and bending alike. A vibration of angular frequency ω then has the
  /// damping ratio ½ωτ, whatever the mesh: 0.6 % at 1 Hz and 60 % at 100 Hz with the default. More: small,
  /// quick wrinkles die sooner, the large motion hardly differs (air brakes that). Real fabric loses a share
  /// of the energy per cycle that depends little on frequency, by friction between yarns; τ stands for it at
  /// one frequency. From 0 to 10; the default is typical of published scenes (ARCSim: 1e-3 to 3e-2) [s].
  double damping = 2e-3;

  /// Distance that two layers keep from each other. Real: 0.1e-3 to 2e-3. More: thicker piles, earlier
  /// contact. From 1e-6 to 0.05 [m].
  double thickness = 0.5e-3;

  /// Coulomb's coefficient of the fabric on itself. Real: 0.2 (silk) to 0.6 (wool). More: slides later. From
  /// 0 to 10 [1].
  double friction = 0.3;

  /// Greatest stretch that the fabric gives in to in any direction, 0.01 for 1 %; 0: none. From 0.85 of it on
  /// a tension grows that stops at about 1.25 of it what no prescribed motion forces (membrane_law.h). Less:
  /// less like rubber, and more work for the solver. `springs` hold to it along each spring [1].
  double strain_limit = 0;

  /// Measured curves along warp and weft, from the origin through these points, at most kMostStretchPoints,
  /// both values and tension over stretch rising; empty: straight lines of slope c11 and c22, which hold in
  /// compression in any case. The membrane stays positive definite: c12² is less than the product of their
  /// least slopes. `springs` do not follow them.
  std::vector<StretchPoint> stretch_warp = {}, stretch_weft = {};
};

/// What is wrong with one number of a fabric.
struct FabricMistake {
  std::string field = {};   // "c12"
  std::string reason = {};  // "must be …, is …"
};

/// Everything that makes a fabric impossible: numbers that are not finite or out of the ranges above, a
/// membrane that is not positive definite, bias bending outside of what is possible, heavier than lead.
WEFT_API std::vector<FabricMistake> find_mistakes(const Fabric& fabric);

/// Throws InputError with all mistakes; `name` is how the fabric is called in the message.
WEFT_API void validate_fabric(const Fabric& fabric, const std::string& name);

/// Rigidity of bending to a cylinder rolled in the direction (c, s) = (cos ψ, sin ψ) from warp [N·m]:
///
///     D(ψ) = bend_warp c⁴ + bend_weft s⁴ + (4 bend_bias − bend_warp − bend_weft) c² s²
///
/// This is how every orthotropic plate bends (S. Timoshenko, Theory of Plates and Shells, 1959, §85), and
/// gives bend_warp, bend_bias and bend_weft exactly at 0°, 45° and 90°.
WEFT_API double bending_rigidity(const Fabric& fabric, double cos_psi, double sin_psi);

/// Where a preset's numbers come from.
struct FabricSources {
  std::string density = {}, stretch = {}, shear = {}, bending = {}, damping = {}, thickness = {},
              friction = {};
};

struct FabricPreset {
  std::string name = {};   // "cotton_shirting"
  std::string title = {};  // one line: what it is
  Fabric fabric = {};
  FabricSources sources = {};
};

/// Five everyday fabrics, then the ten measured by H. Wang, J. O'Brien and R. Ramamoorthi, Data-Driven
/// Elastic Models for Cloth, ACM Transactions on Graphics 30(4), 2011.
WEFT_API const std::vector<FabricPreset>& fabric_presets();

/// The preset of this name; letters may be small or capital, "-" and " " stand for "_". Throws InputError
/// with the nearest name, or all of them.
WEFT_API const FabricPreset& find_fabric_preset(std::string_view name);

/// Its numbers.
WEFT_API const Fabric& find_fabric(std::string_view name);

}  // namespace weft
