/// Edits of pins and colliders by hand.

#include <gtest/gtest.h>

#include "weft/animation/rigid_motion.h"
#include "weft/scene/collider_edits.h"
#include "weft/scene/pin_edits.h"

namespace weft::engine {
namespace {

ClothSceneDesc hung() {
  ClothSceneDesc cloth;
  cloth.pins.push_back({.select = ParticleIndices{{3, 4}}});
  cloth.pins.push_back(
      {.select = ParticleIndices{{8, 9}}, .motion = {{.time = 0}, {.time = 1, .translation = {1, 0, 0}}}});
  return cloth;
}

const PinnedVertices kPinned = {{3, 4}, {8, 9}};

TEST(PinEdits, AddWhatIsFreeToThePinThatIsStill) {
  ClothSceneDesc cloth = hung();
  pin_vertices(std::vector{9, 1, 3, 1}, kPinned, cloth);
  ASSERT_EQ(cloth.pins.size(), 2u);
  EXPECT_EQ(cloth.pins[0].select, ParticleSelection(ParticleIndices{{1, 3, 4}}));
  EXPECT_EQ(cloth.pins[1], hung().pins[1]);
  ClothSceneDesc free;
  pin_vertices(std::vector{5}, {}, free);
  ASSERT_EQ(free.pins.size(), 1u);
  EXPECT_EQ(free.pins[0], PinDesc{.select = ParticleIndices{{5}}});
}

TEST(PinEdits, TakeVerticesAwayAndLeaveThePinItsMotion) {
  ClothSceneDesc cloth = hung();
  unpin_vertices(std::vector{3, 4, 8}, kPinned, cloth);
  ASSERT_EQ(cloth.pins.size(), 1u) << "a pin without vertices is none";
  EXPECT_EQ(cloth.pins[0].select, ParticleSelection(ParticleIndices{{9}}));
  EXPECT_EQ(cloth.pins[0].motion, hung().pins[1].motion);
}

TEST(PinEdits, SelectionsOtherThanOfVerticesStayUnlessTheyLoseSome) {
  ClothSceneDesc cloth;
  cloth.pins.push_back({.select = GridCorner{}});
  unpin_vertices(std::vector{7}, {{0, 1, 2}}, cloth);
  EXPECT_EQ(cloth.pins[0].select, ParticleSelection(GridCorner{}));
  unpin_vertices(std::vector{1}, {{0, 1, 2}}, cloth);
  EXPECT_EQ(cloth.pins[0].select, ParticleSelection(ParticleIndices{{0, 2}}));
}

TEST(ColliderEdits, NewOnesHaveFreeNamesAndGoWithTheirContacts) {
  SceneDesc scene;
  scene.colliders.push_back({.name = "ball", .shape = Sphere{}});
  const std::size_t added = add_collider(NewCollider::ball, {1, 2, 3}, 0.2, scene);
  ASSERT_EQ(added, 1u);
  EXPECT_EQ(scene.colliders[1].name, "ball 2");
  EXPECT_EQ(std::get<Sphere>(scene.colliders[1].shape).center, Vec3(1, 2, 3));
  scene.contacts.push_back({.between = {"sheet", "ball 2"}});
  scene.contacts.push_back({.between = {"sheet", "ball"}});
  remove_collider(1, scene);
  ASSERT_EQ(scene.colliders.size(), 1u);
  ASSERT_EQ(scene.contacts.size(), 1u);
  EXPECT_EQ(scene.contacts[0].between[1], "ball");
}

TEST(ColliderEdits, AnglesAreTheInverseOfTheirRotation) {
  for (const Vec3& angles :
       {Vec3(10, 20, 30), Vec3(-170, 60, 5), Vec3(0, 90, 40), Vec3(33, -90, 0), Vec3(0, 0, 0)}) {
    const Mat3 rotation = rotation_from_angles_deg(angles);
    EXPECT_LT((rotation_from_angles_deg(angles_of(rotation)) - rotation).norm(), 1e-7) << angles.transpose();
  }
}

TEST(ColliderEdits, AHandTurnsABoxAboutAPointAndMovesACapsule) {
  ColliderSceneDesc box{.name = "box", .shape = PlacedBox{.center = {1, 0, 0}, .rotation_deg = {0, 30, 0}}};
  // A quarter turn about the vertical through the origin.
  displace({Vec3::Zero(), rotation_from_angles_deg({0, 90, 0})}, box);
  const PlacedBox& turned = std::get<PlacedBox>(box.shape);
  EXPECT_LT((turned.center - Vec3(0, 0, -1)).norm(), 1e-12);
  EXPECT_LT((rotation_from_angles_deg(turned.rotation_deg) - rotation_from_angles_deg({0, 120, 0})).norm(),
            1e-12);
  ColliderSceneDesc rod{.name = "rod", .shape = Capsule{{0, 0, 0}, {1, 0, 0}, 0.1}};
  displace({Vec3(0, 2, 0), Mat3::Identity()}, rod);
  EXPECT_EQ(std::get<Capsule>(rod.shape).b, Vec3(1, 2, 0));
  EXPECT_TRUE(is_movable(rod));
  EXPECT_FALSE(is_movable({.name = "floor", .shape = Plane{}}));
}

}  // namespace
}  // namespace weft::engine
