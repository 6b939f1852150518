#include "weft/face/build_rest.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "weft/error.h"
#include "weft/fabric/spring_warnings.h"
#include "weft/face/convert.h"

namespace weft::engine {
namespace {

/// The corners of parts of triangles: of each its source's, by weights.
std::vector<TriangleCorners> cut_corners(const std::vector<weft::TriangleCorners>& sources,
                                         const CleanMesh& clean) {
  std::vector<TriangleCorners> parts;
  for (std::size_t t = 0; t < clean.mesh.triangles.size(); ++t) {
    const weft::TriangleCorners& source = sources[clean.source_triangle[t]];
    TriangleCorners& part = parts.emplace_back();
    for (int c = 0; c < 3; ++c) {
      const Vec3& weights = clean.corner_weights[t][c];
      part[c] = Vec3::Zero();
      for (int k = 0; k < 3; ++k) part[c] += weights[k] * to_engine(source[k]);
    }
  }
  return parts;
}

/// The value that a share of the sorted ones is below.
double value_at(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

}  // namespace

void set_rest(const std::vector<weft::TriangleCorners>& given, const CleanMesh& clean, RestMesh& mesh,
              ClothNotes& notes) {
  const int num_without = set_rest(mesh, cut_corners(given, clean));
  if (num_without > 0)
    notes.warnings.push_back(std::to_string(num_without) +
                             (num_without == 1 ? " triangle has" : " triangles have") +
                             " nearly no area in the rest shape, and the shape of the mesh instead");
}

void scale_rest(const std::vector<RestScale>& scales, const std::vector<AddedParticle>& added,
                const WarpField& warp, const ClothNotes& notes, RestMesh& mesh) {
  std::vector<Vec2> factors(mesh.positions.size(), Vec2::Ones());
  for (std::size_t s = 0; s < scales.size(); ++s) {
    const RestScale& scale = scales[s];
    const std::string who = "rest scale " + std::to_string(s) + ": ";
    for (const double factor : {scale.warp, scale.weft}) {
      if (!std::isfinite(factor) || factor <= 0) throw InputError(who + "its factors must be above 0");
    }
    std::vector<char> is_inside(mesh.positions.size(), 0);
    try {
      for (const int v : scale.vertices) {
        const int particle = find_particle(v, notes.particle_of_vertex);
        if (particle >= 0) is_inside[particle] = 1;
      }
    } catch (const InputError& error) {
      throw InputError(who + error.what());
    }
    for (std::size_t i = 0; i < factors.size(); ++i) {
      if (is_inside[i]) factors[i] = factors[i].cwiseProduct(Vec2(scale.warp, scale.weft));
    }
  }
  for (const AddedParticle& between : added) {
    factors[between.particle].setZero();
    for (int corner = 0; corner < 3; ++corner) {
      const int particle = notes.particle_of_vertex[between.vertices[corner]];
      factors[between.particle] +=
          between.weights[corner] * (particle < 0 ? Vec2(Vec2::Ones()) : factors[particle]);
    }
  }
  scale_rest(mesh, warp, factors);
}

void report_rest(const RestMesh& mesh, ClothNotes& notes) {
  constexpr double kFar = 1.25;       // factor of lengths between the mesh and its rest shape
  constexpr double kMaxShare = 0.05;  // of edges that may be beyond it
  if (mesh.at_rest.empty()) return;
  std::vector<double> stretches;
  for (const Edge& e : build_edges(mesh))
    stretches.push_back((mesh.positions[e.b] - mesh.positions[e.a]).norm() / edge_length(mesh, e));
  std::ranges::sort(stretches);
  const auto at = [&](double share) { return short_text(value_at(stretches, share)); };
  notes.done.push_back("its edges start at " + at(0.05) + " to " + at(0.95) +
                       " times their lengths at rest (of nine in ten; median " + at(0.5) + ")");
  const auto num_far = std::ranges::count_if(stretches, [&](double s) { return s > kFar || s < 1 / kFar; });
  if (static_cast<double>(num_far) > kMaxShare * static_cast<double>(stretches.size()))
    notes.warnings.push_back(std::to_string(num_far) + " of " + std::to_string(stretches.size()) +
                             " edges start at more than 1.25 or less than 0.8 times their length at rest; is "
                             "this the pattern of this mesh, and its scale right?");
}

void suggest_rest(const RestMesh& mesh, const std::vector<CornerUv>& uv, ClothNotes& notes) {
  // How much the stretches of nine in ten edges may differ in a pattern, and how little if it changes nothing.
  constexpr double kPattern = 1.4, kSame = 1.02;
  if (uv.empty() || !mesh.at_rest.empty()) return;
  std::vector<double> stretches;
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    const TriangleCorners corners = mesh.corners(t);
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      const double length = (uv[t][next] - uv[t][k]).norm();
      if (!(length > 0) || !std::isfinite(length)) return;
      stretches.push_back((corners[next] - corners[k]).norm() / length);
    }
  }
  std::ranges::sort(stretches);
  const double low = value_at(stretches, 0.05), high = value_at(stretches, 0.95),
               unit = value_at(stretches, 0.5);
  if (low == 0 || high > kPattern * low || high < kSame * low) return;
  notes.done.push_back("its texture coordinates look like its flat pattern, in units of " + short_text(unit) +
                       " m: with rest = \"uv\" its edges would start at about " + short_text(low / unit) +
                       " to " + short_text(high / unit) + " times their lengths at rest");
}

}  // namespace weft::engine
