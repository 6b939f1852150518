#pragma once
/// Fabric in SI units: properties of the cloth, independent of its mesh.
///
/// Stretching is a linear law between Green strain and tension per width in the frame of warp (1) and weft
/// (2), both in the plane of the cloth:
///
///     | tension 1 |   | C11 C12  0 | | strain 1      |      energy per area ½ eᵀ C e [J/m²]
///     | tension 2 | = | C12 C22  0 | | strain 2      |
///     | shear     |   |  0   0   G | | shear angle γ |      γ: warp–weft angle's change from 90° [rad]
///
/// Bending about any axis costs ½ D(ψ) κ² per area, κ the curvature [1/m] of a cylinder rolled in the
/// direction ψ from warp (see bending_rigidity()). With hysteresis it also costs work that is lost.

#include <string>
#include <string_view>
#include <vector>

#include "weft/export.h"

namespace weft {

inline constexpr int kMaxStretchPoints = 8;

/// A point of a measured stretch curve.
struct StretchPoint {
  double strain = 0;   // extension over rest length, > 0 [1]
  double tension = 0;  // force per width, > 0 [N/m]
  bool operator==(const StretchPoint&) const = default;
};

/// The defaults are those of the preset `cotton_shirting`, which gives their sources.
struct Fabric {
  /// Mass per area. Typical: 0.03 (chiffon) to 0.5 (coating). Higher: hangs straighter, swings slower in
  /// wind. > 0, and at most that of sheet lead of the fabric's thickness [kg/m²].
  double density = 0.12;

  /// Stretching stiffness along warp. Typical: 25 (jumper) to 10000 (canvas). Higher: sags and stretches
  /// less. > 0 [N/m].
  double c11 = 2800;

  /// Along weft: as c11 [N/m].
  double c22 = 1400;

  /// Coupling: contraction across the direction of stretching. c12² < c11 c22 keeps the matrix positive
  /// definite. Higher: narrows more when pulled; 0 for most woven fabric. May be negative [N/m].
  double c12 = 0;

  /// Shearing stiffness, force per width and radian. Typical: 14 (silk) to 120 (denim), leather 700. Lower:
  /// drapes softer and fits double curvature better. > 0 [N/m].
  double g = 45;

  /// Bending rigidity along warp: a cylinder around weft threads. Typical: 1e-6 (silk) to 1e-4 (coating).
  /// Higher: larger, fewer folds. >= 0 [N·m].
  double bend_warp = 7e-6;

  /// Along weft: as bend_warp [N·m].
  double bend_weft = 6e-6;

  /// Along the bias, at 45°. At least (√bend_warp − √bend_weft)²/4: below that, some bending would release
  /// energy [N·m].
  double bend_bias = 6e-6;

  /// Hysteresis of bending along warp, 2HB of KES-F: threads rub, and the moment per width is this much larger
  /// while cloth bends than while it unbends. Typical: 1e-4 (silk) to 5e-3 (coating). Higher: stiffer, fewer
  /// folds, which stay; 0: none. Needs `newton` or `implicit_euler`. >= 0 [N].
  double bend_hysteresis_warp = 0;

  /// Along weft: as bend_hysteresis_warp [N].
  double bend_hysteresis_weft = 0;

  /// Curvature of threads beyond which bending stays: cloth that was bent more sharply is flat no more. Typical:
  /// 500 (a crease of 2 mm radius) to 2000. Lower: creases sooner; 0: never. Integrators as above. >= 0 [1/m].
  double bend_set = 0;

  /// Time constant τ of internal damping (Kelvin–Voigt): every elastic stress σ(e) has a viscous companion τ
  /// dσ/dt, in stretching, shearing and bending alike. A vibration of angular frequency ω then has the
  /// damping ratio ½ωτ, independent of the mesh: with the default 0.6 % at 1 Hz and 60 % at 100 Hz. Higher:
  /// small, quick wrinkles decay sooner; large motion, which air brakes, hardly changes. Real fabric loses
  /// energy by friction between yarns, a share per cycle that depends little on frequency; τ matches it at
  /// one frequency. From 0 to 10; the default is typical of published scenes (ARCSim: 1e-3 to 3e-2) [s].
  double damping = 2e-3;

  /// Minimum distance between two layers. Typical: 0.1e-3 to 2e-3. Higher: thicker stacks, earlier contact.
  /// From 1e-6 to 0.05 [m].
  double thickness = 0.5e-3;

  /// Coulomb coefficient of the fabric on itself. Typical: 0.2 (silk) to 0.6 (wool). Higher: slides later.
  /// From 0 to 10 [1].
  double friction = 0.3;

  /// Strain limit in any direction, 0.01 for 1 %; 0: none. Beyond 0.85 times the limit an additional tension
  /// grows; it stops unforced motion at about 1.25 times the limit (membrane_law.h). Lower: less rubbery, and
  /// more work for the solver. `springs` apply it along each spring [1].
  double strain_limit = 0;

  /// Tension at which the fabric tears, in any direction; 0: never. Strips for tests of breaking force are 50 mm wide:
  /// 500 N are 10000 N/m. Typical: 3000 (chiffon) to 40000 (denim), less for an effect. Higher: tears later. Needs
  /// triangles as membranes; not with hysteresis or set of bending. >= 0 [N/m].
  double strength = 0;

  /// Measured curves along warp and weft, from the origin through these points, at most kMaxStretchPoints;
  /// strain, tension and tension over stretch must rise. Empty: straight lines of slope c11 and c22, which
  /// always apply in compression. The membrane stays positive definite: c12² is less than the product of the
  /// curves' least slopes. `springs` ignore them.
  std::vector<StretchPoint> stretch_warp = {}, stretch_weft = {};
  bool operator==(const Fabric&) const = default;
};

/// An invalid number of a fabric.
struct FabricMistake {
  std::string field = {};   // "c12"
  std::string reason = {};  // "must be …, is …"
};

/// All reasons that make a fabric invalid: numbers that are not finite or out of the ranges above, a membrane
/// that is not positive definite, bias bending out of its range, heavier than lead.
WEFT_API std::vector<FabricMistake> find_mistakes(const Fabric& fabric);

/// Throws InputError with all mistakes; the message calls the fabric `name`.
WEFT_API void validate_fabric(const Fabric& fabric, const std::string& name);

/// Bending rigidity for a cylinder rolled in the direction (c, s) = (cos ψ, sin ψ) from warp [N·m]:
///
///     D(ψ) = bend_warp c⁴ + bend_weft s⁴ + (4 bend_bias − bend_warp − bend_weft) c² s²
///
/// This is the law of every orthotropic plate (S. Timoshenko, Theory of Plates and Shells, 1959, §85). It
/// gives bend_warp, bend_bias and bend_weft exactly at 0°, 45° and 90°.
WEFT_API double bending_rigidity(const Fabric& fabric, double cos_psi, double sin_psi);

/// How the threads of a fabric cross or loop.
enum class Weave { none, plain, twill, satin, knit };

/// Appearance of a fabric in pictures; without effect on motion. The defaults are those of a smooth surface.
struct FabricLook {
  Weave weave = Weave::none;
  double thread = 0;  // distance of neighbouring threads, of a knit its stitches; > 0 with a weave [m]
  double translucency = 0.25;  // share of sunlight that passes, from 0 to 1
  double sheen = 0.3;          // light from fibres that stand out, at grazing angles, from 0 to 1
  double gloss = 0.05;         // reflection of the surroundings, from 0 to 1
  double weft_shade = 1;       // brightness of the weft; 1: as the warp, from 0 (black) to 10
  bool operator==(const FabricLook&) const = default;
};

/// Sources of a preset's numbers.
struct FabricSources {
  std::string density = {}, stretch = {}, shear = {}, bending = {}, damping = {}, thickness = {},
              friction = {};
};

struct FabricPreset {
  std::string name = {};   // "cotton_shirting"
  std::string title = {};  // description in one line
  Fabric fabric = {};
  FabricSources sources = {};
  FabricLook look = {};
};

/// Five everyday fabrics, then the ten measured by H. Wang, J. O'Brien and R. Ramamoorthi, Data-Driven
/// Elastic Models for Cloth, ACM Transactions on Graphics 30(4), 2011.
WEFT_API const std::vector<FabricPreset>& fabric_presets();

/// The preset of this name; case is ignored, "-" and " " stand for "_". Throws InputError with the nearest
/// name, or with all names.
WEFT_API const FabricPreset& find_fabric_preset(std::string_view name);

/// The fabric of find_fabric_preset(name).
WEFT_API const Fabric& find_fabric(std::string_view name);

}  // namespace weft
