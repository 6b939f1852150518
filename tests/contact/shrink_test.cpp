/// Thinner solids keep their shape, and thin ones do not invert.

#include "weft/contact/shrink.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "weft/mesh/clean.h"
#include "weft/mesh/solid.h"

namespace weft::engine {
namespace {

TriangleMesh join(TriangleMesh mesh, const TriangleMesh& other) {
  const int first = mesh.num_vertices();
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
  return mesh;
}

TriangleMesh ball(double radius) {
  return clean_mesh(make_sphere_mesh(Vec3::Zero(), radius, 24), {.weld_distance = 0}).mesh;
}

TriangleMesh bar(double radius) {
  const TriangleMesh mesh = make_capsule_mesh({-0.2, 0, 0}, {0.2, 0, 0}, radius, 24);
  return clean_mesh(mesh, {.weld_distance = 0}).mesh;
}

TEST(Shrink, InnerRadiiOfABallAndABarAreTheirOwn) {
  for (const TriangleMesh& mesh : {ball(0.1), bar(0.1)}) {
    const std::vector<double> radii = compute_inner_radii(mesh, 1, *make_serial_jobs());
    EXPECT_GT(*std::min_element(radii.begin(), radii.end()), 0.095);
    EXPECT_LT(*std::max_element(radii.begin(), radii.end()), 0.1005);
  }
}

TEST(Shrink, AShellAroundAnotherIsAsThickAsTheWhole) {
  const TriangleMesh head = ball(0.1), hair = ball(0.11);
  const std::vector<double> radii = compute_inner_radii(join(head, hair), 1, *make_serial_jobs());
  for (const double radius : radii) EXPECT_GT(radius, 0.095);
}

TEST(Shrink, ABarBecomesThinnerByTheDepthAndNeverTurnsInsideOut) {
  constexpr double kRadius = 0.04;
  TriangleMesh mesh = bar(kRadius);
  const TriangleMesh full = mesh;
  const std::vector<double> radii = compute_inner_radii(full, 1, *make_serial_jobs());
  for (const double depth : {0.01, 0.03, 0.1}) {
    mesh.positions = shrink(full, radii, depth);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const Vec3& p = full.positions[v];
      if (std::abs(p.x()) > 0.15) continue;  // ends shrink as well
      const double from_axis = std::hypot(mesh.positions[v].y(), mesh.positions[v].z());
      EXPECT_NEAR(from_axis, std::max(kRadius - depth, 0.1 * kRadius), 0.1 * kRadius);
    }
    EXPECT_GT(compute_signed_volume(mesh), 0);
  }
}

}  // namespace
}  // namespace weft::engine
