#pragma once
/// Response of a membrane to strain: the fabric's linear law, its stretch curves, and its strain limit.
///
///     tension                    A principal stretch σ (length of a direction over rest length) beyond the
///        |            /          limit has an additional tension, with u = σ − 1 − begin:
///        |           / k
///        |        _.´               k u²/(2 w)          for u < w = full − begin
///        |____..-´                  k (u − w/2)         beyond
///        0   begin full
///                                The energy is convex in the positions for any such law that only pulls, and
///                                smooth (C²), which suits Newton's method.

#include <utility>
#include <vector>

#include "weft/core/vec.h"
#include "weft/fabric.h"

namespace weft::engine {

/// Limit of principal stretches (stiffness in N/m), or of a spring (in N).
struct StrainLimit {
  double begin = 0;      // strain above which the limit pulls [1]
  double full = 0;       // strain above which its stiffness is full [1]
  double stiffness = 0;  // k; 0: no limit

  /// Maximum strain that a solver may leave: twice as far beyond `begin` as `full` is, 1.25 times the
  /// fabric's strain_limit [1].
  double allowed() const { return begin + 2 * (full - begin); }
};

/// Energy, tension and stiffness at a strain: per area of a membrane [J/m², N/m, N/m], per rest length of a
/// spring [N, N, N].
struct LimitResponse {
  double energy = 0, tension = 0, stiffness = 0;
};
LimitResponse limit_response(const StrainLimit& limit, double strain);

/// Limit for a cloth of this area [m²] and this mean edge length [m]. It begins at 0.85 and is full at 1.05
/// times strain_limit. At 1.3 times, it bears twenty times the cloth's weight on a single edge: more than the
/// load of cloth that is dropped, swung or pulled. None for strain_limit = 0.
StrainLimit make_strain_limit(const Fabric& fabric, double cloth_area, double edge_length);

/// A Green strain along a thread at which the slope of the stress changes.
struct StretchKink {
  double strain = 0;  // >= 0 [1]
  double slope = 0;   // change of slope; negative: less steep [N/m]
};

/// Deviation of a measured curve from a straight line of slope `linear` [N/m]: kinks by ascending strain,
/// none without a curve. Stress is tension over stretch, T/(1 + ε) at the Green strain ε + ε²/2; it is
/// piecewise linear between the points and extrapolated beyond the last one. It has the slope `linear` in
/// compression, and up to the first point if its initial slope is within 5 % of that.
std::vector<StretchKink> make_stretch_kinks(const std::vector<StretchPoint>& curve, double linear);

struct MembraneLaw {
  Mat3 stiffness = Mat3::Zero();  // C [N/m]
  StrainLimit limit;
  std::vector<StretchKink> warp, weft;

  MembraneLaw() = default;
  MembraneLaw(const Mat3& c, const StrainLimit& l = {}, std::vector<StretchKink> along_warp = {},
              std::vector<StretchKink> along_weft = {})
      : stiffness(c), limit(l), warp(std::move(along_warp)), weft(std::move(along_weft)) {}
};

/// Response at the Green strain e = (ε11, ε22, 2 ε12).
struct MembraneResponse {
  double energy = 0;            // per area [J/m²]
  Vec3 stress = Vec3::Zero();   // ∂energy/∂e [N/m]
  Mat3 tangent = Mat3::Zero();  // ∂stress/∂e: positive semidefinite [N/m]
};
MembraneResponse membrane_response(const MembraneLaw& law, const Vec3& strain);

/// Response of a pair of triangles to the difference of their strains: linear and soft up to a strain, and
/// beyond it along warp and weft as stiff as the fabric. It is zero where both have the same strain.
struct PatchDifference {
  double stiffness = 0;       // of all three strains [N/m]
  double begin = 0;           // strain difference above which threads are stiff [1]
  double warp = 0, weft = 0;  // additional stiffness beyond it, >= 0 [N/m]
};
PatchDifference make_patch_difference(const Fabric& fabric);
MembraneResponse difference_response(const PatchDifference& law, const Vec3& difference);

/// Law of a patch. The strain limit is of each triangle, for a mean would let single ones stretch beyond it.
struct PatchLaw {
  MembraneLaw alone;  // of a single triangle
  MembraneLaw mean;   // of a pair: without the limit
  MembraneLaw limit;  // of each triangle of a pair: the limit only
  PatchDifference difference;

  PatchLaw(const MembraneLaw& law, const PatchDifference& of_difference)
      : alone(law),
        mean(law.stiffness, {}, law.warp, law.weft),
        limit(Mat3::Zero(), law.limit),
        difference(of_difference) {}
};

}  // namespace weft::engine
