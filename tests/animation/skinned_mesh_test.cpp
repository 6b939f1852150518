#include "weft/animation/skinned_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "weft/core/angle.h"

namespace weft::engine {
namespace {

constexpr double kRounding = 1e-15;  // some four roundings of coordinates up to 2, 2.2e-16 each

std::vector<Vec3> at(const SkinnedMesh& mesh, double time) {
  std::vector<Vec3> positions;
  mesh.evaluate(time, positions);
  EXPECT_EQ(static_cast<int>(positions.size()), mesh.num_vertices());
  return positions;
}

void expect_near(const Vec3& actual, const Vec3& expected, double tolerance = kRounding) {
  EXPECT_LE((actual - expected).cwiseAbs().maxCoeff(), tolerance)
      << actual.transpose() << ", expected " << expected.transpose();
}

Affine move_by(const Vec3& translation) { return Affine(Eigen::Translation3d(translation)); }

Eigen::Quaterniond about_z(double angle_deg) {
  const SinCos half = sin_cos_deg(angle_deg / 2);
  return {half.cos, 0, 0, half.sin};
}

AnimationCurve rotation_curve(const std::vector<double>& times, const std::vector<double>& angles_deg) {
  AnimationCurve curve{.times = times};
  for (const double angle : angles_deg) {
    const Eigen::Vector4d q = about_z(angle).coeffs();
    curve.values.insert(curve.values.end(), q.begin(), q.end());
  }
  return curve;
}

/// Appends a vertex with the weights of its joints.
void add_vertex(SkinnedPart& part, const Vec3& x, const std::vector<Influence>& influences) {
  if (part.first_influence.empty()) part.first_influence = {0};
  part.rest.push_back(x);
  part.influences.insert(part.influences.end(), influences.begin(), influences.end());
  part.first_influence.push_back(part.influences.size());
}

/// An arm along y from (0, 0, 0) to (0, 2, 0), with joints at its root and middle (nodes 0 and 1). The second
/// one turns about z by 90 degrees from 0 to 1 s. Node 2 has the mesh.
SkinnedMeshDesc make_arm() {
  SkinnedMeshDesc arm;
  arm.nodes = {{}, {.parent = 0, .translation = {0, 1, 0}, .rotations = rotation_curve({0, 1}, {0, 90})}, {}};
  arm.skins = {{.joints = {0, 1}, .inverse_bind = {Affine::Identity(), move_by({0, -1, 0})}}};
  SkinnedPart& part = arm.parts.emplace_back(SkinnedPart{.node = 2, .skin = 0});
  add_vertex(part, {0.25, 0, 0}, {{0, 1}});
  add_vertex(part, {0.25, 1, 0.5}, {{0, 0.5}, {1, 0.5}});
  add_vertex(part, {0.25, 2, 0}, {{0, 0}, {1, 1}});
  arm.end = 1;
  return arm;
}

TEST(SkinnedMesh, BendsAnArmByHandCalculatedPositions) {
  const SkinnedMesh arm(make_arm());
  EXPECT_EQ(arm.num_vertices(), 3);
  EXPECT_EQ(arm.start(), 0);
  EXPECT_EQ(arm.end(), 1);
  EXPECT_EQ(at(arm, 0), (std::vector<Vec3>{{0.25, 0, 0}, {0.25, 1, 0.5}, {0.25, 2, 0}}));
  // At 90 degrees the fore-arm maps (x, 1 + y) to (−y, 1 + x).
  const std::vector<Vec3> bent = at(arm, 1);
  EXPECT_EQ(bent[0], Vec3(0.25, 0, 0));
  expect_near(bent[1], {0.125, 1.125, 0.5});  // the mean of (0.25, 1) and (0, 1.25)
  expect_near(bent[2], {-1, 1.25, 0});
  EXPECT_EQ(at(arm, 100), bent);
  for (double time = 0; time <= 1; time += 0.03125) {
    const SinCos a = sin_cos_deg(90 * time);
    const Vec3 forearm(0.25 * a.cos - a.sin, 1 + 0.25 * a.sin + a.cos, 0);
    expect_near(at(arm, time)[2], forearm);
    expect_near(at(arm, time)[1], {(0.25 + 0.25 * a.cos) / 2, (2 + 0.25 * a.sin) / 2, 0.5});
  }
}

TEST(SkinnedMesh, IsAPureFunctionOfTime) {
  const SkinnedMesh arm(make_arm());
  const std::vector<Vec3> early = at(arm, 0.3), late = at(arm, 0.9);
  EXPECT_EQ(at(arm, 0.3), early);
  EXPECT_EQ(at(SkinnedMesh(make_arm()), 0.9), late);
  EXPECT_NE(early, late);
}

TEST(SkinnedMesh, IgnoresTheTransformOfTheSkinnedNode) {
  const std::vector<Vec3> expected = at(SkinnedMesh(make_arm()), 0.7);
  SkinnedMeshDesc moved = make_arm();
  moved.nodes[2].translation = {5, 6, 7};
  moved.nodes[2].scale = {2, -3, 4};
  moved.nodes[2].rotations = rotation_curve({0, 1}, {0, 50});
  EXPECT_EQ(at(SkinnedMesh(moved), 0.7), expected);
  moved.nodes[2].parent = 1;
  EXPECT_EQ(at(SkinnedMesh(moved), 0.7), expected);
}

TEST(SkinnedMesh, FollowsTheAncestorsOfItsJoints) {
  SkinnedMeshDesc arm = make_arm();
  arm.nodes.push_back({.translation = {1, 2, 3}, .scale = {2, 2, 2}});
  arm.nodes[0].parent = 3;  // a parent with a larger index
  const std::vector<Vec3> arm_before = at(SkinnedMesh(make_arm()), 1), arm_after = at(SkinnedMesh(arm), 1);
  for (int v = 0; v < 3; ++v) EXPECT_EQ(arm_after[v], Vec3(1, 2, 3) + 2 * arm_before[v]);
}

TEST(SkinnedMesh, TakesAnyNumberOfInfluences) {
  SkinnedMeshDesc desc;
  Skin& skin = desc.skins.emplace_back();
  std::vector<Influence> influences;
  for (int j = 0; j < 8; ++j) {
    // Joint j moves by (j, j², 0) in a second, with the weight (j + 1) / 36.
    desc.nodes.push_back({.translations = {.times = {0, 1}, .values = {0, 0, 0, 1.0 * j, 1.0 * j * j, 0}}});
    skin.joints.push_back(j);
    skin.inverse_bind.push_back(Affine::Identity());
    influences.push_back({j, (j + 1) / 36.0});
  }
  desc.nodes.emplace_back();
  add_vertex(desc.parts.emplace_back(SkinnedPart{.node = 8, .skin = 0}), {0, 0, 1}, influences);
  // Σ j (j + 1) = 168, Σ j² (j + 1) = 924.
  expect_near(at(SkinnedMesh(desc), 1)[0], {168 / 36.0, 924 / 36.0, 1}, 1e-14);
  expect_near(at(SkinnedMesh(desc), 0.5)[0], {84 / 36.0, 462 / 36.0, 1}, 1e-14);
}

TEST(SkinnedMesh, DividesWeightsByTheirSum) {
  SkinnedMeshDesc arm = make_arm();
  SkinnedPart& part = arm.parts[0];
  part.influences[1].weight = 6;  // vertex 1: 6 and 2 instead of 0.5 and 0.5
  part.influences[2].weight = 2;
  part.influences[4].weight = 1e-30;  // vertex 2: only this one
  const std::vector<Vec3> bent = at(SkinnedMesh(arm), 1);
  expect_near(bent[1], {0.1875, 1.0625, 0.5});  // ¾ (0.25, 1) + ¼ (0, 1.25)
  expect_near(bent[2], {-1, 1.25, 0});
}

TEST(SkinnedMesh, VertexWithoutWeightsFollowsItsFirstJoint) {
  SkinnedMeshDesc arm = make_arm();
  add_vertex(arm.parts[0], {0, 2, 0}, {{1, 0}, {0, 0}});
  expect_near(at(SkinnedMesh(arm), 1)[3], {-1, 1, 0});
}

TEST(SkinnedMesh, PartsMayShareJoints) {
  SkinnedMeshDesc arm = make_arm();
  // A sleeve in other coordinates, a metre to the right, on the same joints in the other order.
  arm.skins.push_back({.joints = {1, 0}, .inverse_bind = {move_by({-1, -1, 0}), move_by({-1, 0, 0})}});
  SkinnedPart& sleeve = arm.parts.emplace_back(SkinnedPart{.node = 2, .skin = 1});
  add_vertex(sleeve, {1.25, 2, 0}, {{0, 1}, {1, 0}});
  add_vertex(sleeve, {1.25, 0, 0}, {{0, 0}, {1, 1}});
  const std::vector<Vec3> bent = at(SkinnedMesh(arm), 1);
  ASSERT_EQ(bent.size(), 5u);
  EXPECT_EQ(bent[3], bent[2]);
  EXPECT_EQ(bent[4], bent[0]);
}

TEST(SkinnedMesh, UnskinnedPartsAreAtTheirNode) {
  SkinnedMeshDesc desc;
  // World = T(1, 2, 3) · R(90° about z) · S(2, 3, 4) · T(1, 0, 0) · S(1, −1, 1).
  desc.nodes = {{.translation = {1, 2, 3}, .rotation = about_z(90), .scale = {2, 3, 4}},
                {.parent = 0, .translation = {1, 0, 0}, .scale = {1, -1, 1}}};
  desc.parts = {{.node = 1, .rest = {{0, 0, 0}, {1, 1, 1}}}};
  const SkinnedMesh still(desc);
  expect_near(at(still, 0)[0], {1, 4, 3}, 1e-15);  // (1, 0, 0) → (2, 0, 0) → (0, 2, 0)
  expect_near(at(still, 0)[1], {4, 6, 7}, 1e-15);  // (2, −1, 1) → (4, −3, 4) → (3, 4, 4)
  EXPECT_TRUE(still.is_mirrored(0));

  // The same with the parent as a matrix, and with the child's scale animated.
  Affine matrix = move_by({1, 2, 3});
  matrix.linear() << 0, -3, 0, 2, 0, 0, 0, 0, 4;
  desc.nodes[0] = {.matrix = matrix};
  EXPECT_EQ(at(SkinnedMesh(desc), 0)[1], Vec3(4, 6, 7));
  desc.nodes[1].scales = {.times = {0, 1}, .values = {1, 1, 1, 3, 1, 1}};
  const SkinnedMesh moving(desc);
  EXPECT_EQ(at(moving, 0)[1], Vec3(-2, 6, 7));
  EXPECT_EQ(at(moving, 1)[1], Vec3(-2, 10, 7));
  EXPECT_FALSE(moving.is_mirrored(0));
}

TEST(SkinnedMesh, StillNodesMoveWithTheirAncestors) {
  SkinnedMeshDesc desc;
  // Node 2 is a still child of a still child of a node that moves; node 3 is still.
  desc.nodes = {{.translations = {.times = {0, 1}, .values = {0, 0, 0, 8, 0, 0}}},
                {.parent = 0, .translation = {0, 1, 0}},
                {.parent = 1, .translation = {0, 0, 1}},
                {.translation = {5, 5, 5}}};
  desc.parts = {{.node = 2, .rest = {{0, 0, 0}}}, {.node = 3, .rest = {{0, 0, 0}, {1, 0, 0}}}};
  const SkinnedMesh mesh(desc);
  EXPECT_EQ(at(mesh, 0), (std::vector<Vec3>{{0, 1, 1}, {5, 5, 5}, {6, 5, 5}}));
  EXPECT_EQ(at(mesh, 0.25), (std::vector<Vec3>{{2, 1, 1}, {5, 5, 5}, {6, 5, 5}}));
}

TEST(SkinnedMesh, MorphTargetsDisplaceVerticesBeforeTheyArePlaced) {
  SkinnedMeshDesc desc;
  desc.nodes = {{.translation = {0, 0, 5}, .scale = {2, 2, 2}}};
  SkinnedPart& part = desc.parts.emplace_back();
  part.rest = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  part.targets = {{{1, {0, 1, 0}}}, {{1, {0, 0, 4}}, {2, {1, 0, 0}}}};
  part.weights = {0.5, -0.25};
  const std::vector<Vec3> constant = at(SkinnedMesh(desc), 3);
  EXPECT_EQ(constant, (std::vector<Vec3>{{0, 0, 5}, {2, 1, 3}, {-0.5, 2, 5}}));

  desc.nodes[0].weights = {.times = {0, 1}, .values = {0, 0, 1, 2}};
  const SkinnedMesh animated(desc);
  EXPECT_EQ(at(animated, 0), (std::vector<Vec3>{{0, 0, 5}, {2, 0, 5}, {0, 2, 5}}));
  EXPECT_EQ(at(animated, 0.25), (std::vector<Vec3>{{0, 0, 5}, {2, 0.5, 9}, {1, 2, 5}}));
  EXPECT_EQ(at(animated, 1), (std::vector<Vec3>{{0, 0, 5}, {2, 2, 21}, {4, 2, 5}}));

  // With a skin: displaced at rest, then bent.
  SkinnedMeshDesc arm = make_arm();
  arm.parts[0].targets = {{{2, {0, 1, 0}}}};
  arm.nodes[2].weights = {.times = {0, 1}, .values = {0, 1}};
  expect_near(at(SkinnedMesh(arm), 1)[2], {-2, 1.25, 0});
}

TEST(SkinnedMesh, JointsOfAMirroredTreeMirrorTheirVertices) {
  SkinnedMeshDesc arm = make_arm();
  EXPECT_FALSE(SkinnedMesh(arm).is_mirrored(0));
  arm.nodes[0].scale = {-1, 1, 1};
  const SkinnedMesh mirrored(arm);
  EXPECT_TRUE(mirrored.is_mirrored(0));
  expect_near(at(mirrored, 1)[2], {1, 1.25, 0});
}

}  // namespace
}  // namespace weft::engine
