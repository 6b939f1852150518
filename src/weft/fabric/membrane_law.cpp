#include "weft/fabric/membrane_law.h"

#include <algorithm>
#include <cmath>

namespace weft::engine {
namespace {

/// Of a pair of triangles. The share of the shear stiffness is enough for cloth at rest to have no modes without
/// energy; the difference is that of a triangle 2 % longer and one 2 % shorter than both.
constexpr double kDifferenceShare = 0.25, kLargeDifference = 0.04;
constexpr double kBegin = 0.85, kFull = 1.05, kLoaded = 1.3;  // of the fabric's strain limit
constexpr double kTimesWeight = 20;                           // load of a single edge at kLoaded
constexpr double kGravity = 9.81;
constexpr double kSameSlope = 0.05;  // an initial slope within this share of the linear one is replaced by it

/// ψ(e) of a principal Green strain e = (σ² − 1)/2, and its derivatives by e.
struct Principal {
  double energy = 0, first = 0, second = 0;
};

Principal principal(const StrainLimit& limit, double green) {
  const double stretch = std::sqrt(std::max(0.0, 1 + 2 * green));
  const LimitResponse r = limit_response(limit, stretch - 1);
  if (r.tension == 0) return {};
  return {r.energy, r.tension / stretch, (r.stiffness - r.tension / stretch) / (stretch * stretch)};
}

/// Adds the limit's response, in the principal axes of the strain.
void add_limit(const StrainLimit& limit, const Vec3& e, MembraneResponse& response) {
  const double mean = (e[0] + e[1]) / 2, half = (e[0] - e[1]) / 2, shear = e[2] / 2;
  const double radius = std::sqrt(half * half + shear * shear);
  const Principal p1 = principal(limit, mean + radius), p2 = principal(limit, mean - radius);
  if (p1.first == 0) return;
  const bool has_axes = radius > 1e-9;
  const double c = has_axes ? half / radius : 1, s = has_axes ? shear / radius : 0;
  const double turning = has_axes ? (p1.first - p2.first) / (2 * radius) : p1.second;
  const Vec3 v1(0.5 * (1 + c), 0.5 * (1 - c), 0.5 * s), v2(0.5 * (1 - c), 0.5 * (1 + c), -0.5 * s);
  const Vec3 v3(-0.5 * s, 0.5 * s, 0.5 * c);
  response.energy += p1.energy + p2.energy;
  response.stress += p1.first * v1 + p2.first * v2;
  response.tangent +=
      p1.second * v1 * v1.transpose() + p2.second * v2 * v2.transpose() + 2 * turning * v3 * v3.transpose();
}

void add_curve(const std::vector<StretchKink>& kinks, int thread, double strain, MembraneResponse& response) {
  for (const StretchKink& kink : kinks) {
    const double beyond = strain - kink.strain;
    if (beyond <= 0) return;
    response.energy += 0.5 * kink.slope * beyond * beyond;
    response.stress[thread] += kink.slope * beyond;
    response.tangent(thread, thread) += kink.slope;
  }
}

}  // namespace

std::vector<StretchKink> make_stretch_kinks(const std::vector<StretchPoint>& curve, double linear) {
  std::vector<StretchKink> kinks;
  double strain = 0, stress = 0, slope = linear;
  for (const StretchPoint& p : curve) {
    const double next_strain = p.strain + p.strain * p.strain / 2, next_stress = p.tension / (1 + p.strain);
    const double next_slope = (next_stress - stress) / (next_strain - strain);
    const bool begins_as_line = strain == 0 && std::abs(next_slope - linear) < kSameSlope * linear;
    if (!begins_as_line) kinks.push_back({strain, next_slope - slope});
    slope = begins_as_line ? linear : next_slope;
    stress = begins_as_line ? linear * next_strain : next_stress;
    strain = next_strain;
  }
  return kinks;
}

LimitResponse limit_response(const StrainLimit& limit, double strain) {
  const double u = strain - limit.begin, w = limit.full - limit.begin, k = limit.stiffness;
  if (k == 0 || u <= 0) return {};
  if (u < w) return {k * u * u * u / (6 * w), k * u * u / (2 * w), k * u / w};
  return {k * (w * w / 6 - u * w / 2 + u * u / 2), k * (u - w / 2), k};
}

StrainLimit make_strain_limit(const Fabric& fabric, double cloth_area, double edge_length) {
  if (fabric.strain_limit == 0) return {};
  const double tension = kTimesWeight * kGravity * fabric.density * cloth_area / edge_length;
  StrainLimit limit{kBegin * fabric.strain_limit, kFull * fabric.strain_limit, 1};
  limit.stiffness = tension / limit_response(limit, kLoaded * fabric.strain_limit).tension;
  return limit;
}

PatchDifference make_patch_difference(const Fabric& fabric) {
  const double soft = kDifferenceShare * fabric.g;
  return {soft, kLargeDifference, std::max(0.0, fabric.c11 - soft), std::max(0.0, fabric.c22 - soft)};
}

MembraneResponse difference_response(const PatchDifference& law, const Vec3& difference) {
  MembraneResponse response{0.5 * law.stiffness * difference.squaredNorm(), law.stiffness * difference,
                            law.stiffness * Mat3::Identity()};
  for (const int thread : {0, 1}) {
    const double beyond = std::abs(difference[thread]) - law.begin;
    if (beyond <= 0) continue;
    const double stiffness = thread == 0 ? law.warp : law.weft;
    response.energy += 0.5 * stiffness * beyond * beyond;
    response.stress[thread] += std::copysign(stiffness * beyond, difference[thread]);
    response.tangent(thread, thread) += stiffness;
  }
  return response;
}

MembraneResponse membrane_response(const MembraneLaw& law, const Vec3& e) {
  MembraneResponse response{0, law.stiffness * e, law.stiffness};
  response.energy = 0.5 * e.dot(response.stress);
  add_curve(law.warp, 0, e[0], response);
  add_curve(law.weft, 1, e[1], response);
  if (law.limit.stiffness > 0) add_limit(law.limit, e, response);
  return response;
}

}  // namespace weft::engine
