#pragma once
/// What a membrane answers to a strain: the fabric's linear law, its stretch curves, and its strain limit.
///
///     tension                   A principal stretch σ (the length of a direction over that at rest) beyond
///     the
///        |            /         limit is held back by a tension of its own, with u = σ − 1 − begin:
///        |           / k
///        |        _.´               k u²/(2 w)          for u < w = full − begin
///        |____..-´                  k (u − w/2)         beyond
///        0   begin full
///                               The energy is convex in the positions for any such law that only pulls, and
///                               smooth (C²), so that Newton's method follows it.

#include <utility>
#include <vector>

#include "weft/core/vec.h"
#include "weft/fabric.h"

namespace weft::engine {

/// Of principal stretches (stiffness in N/m), or of a spring (in N).
struct StrainLimit {
  double begin = 0;      // strain at which it begins to pull [1]
  double full = 0;       // strain from which its stiffness is full [1]
  double stiffness = 0;  // k; 0: there is no limit

  /// The strain that a solver may leave a stretch at: twice as far beyond `begin` as where it is full,
  /// 1.25 times the fabric's strain_limit [1].
  double allowed() const { return begin + 2 * (full - begin); }
};

/// Energy, tension and stiffness at a strain: per area of a membrane [J/m², N/m, N/m], per rest length of a
/// spring [N, N, N].
struct LimitResponse {
  double energy = 0, tension = 0, stiffness = 0;
};
LimitResponse limit_response(const StrainLimit& limit, double strain);

/// The limit of a cloth of this area, of triangles whose edges are about so long [m²], [m]. It begins at
/// 0.85 strain_limit, is full at 1.05 of it, and bears at 1.3 of it what twenty times the cloth's weight make
/// of tension when a single edge holds it: more than cloth that is dropped, swung or pulled does. None for
/// strain_limit = 0.
StrainLimit make_strain_limit(const Fabric& fabric, double cloth_area, double edge_length);

/// From a Green strain along a thread on, the stress along it rises more steeply than before.
struct StretchKink {
  double strain = 0;  // >= 0 [1]
  double slope = 0;   // by so much; negative: less steeply [N/m]
};

/// What a measured curve is beyond a straight line of slope `linear` [N/m]: kinks by ascending strain, none
/// for no curve. Stress is tension over stretch, T/(1 + ε) at the Green strain ε + ε²/2; it is straight
/// between the points and goes on beyond the last one. It is that of `linear` in compression, and up to the
/// first point if it begins within 5 % of that.
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

/// At the Green strain e = (ε11, ε22, 2 ε12).
struct MembraneResponse {
  double energy = 0;            // per area [J/m²]
  Vec3 stress = Vec3::Zero();   // ∂energy/∂e [N/m]
  Mat3 tangent = Mat3::Zero();  // ∂stress/∂e: positive semidefinite [N/m]
};
MembraneResponse membrane_response(const MembraneLaw& law, const Vec3& strain);

}  // namespace weft::engine
