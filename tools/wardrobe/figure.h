#pragma once
/// A human figure for garments: a mesh of smoothly joined round cones, a shell of hair, and a skeleton.
///
/// At rest the arms are 30 degrees below the horizontal, y is up, the face points along z, the feet are on y
/// = 0. Vertices follow nearby bones (linear blend skinning). The skin therefore intersects itself at
/// armpits, elbows and crotch, like that of many game characters.

#include <array>
#include <string>
#include <vector>

#include "tools/wardrobe/isosurface.h"

namespace weft::engine::wardrobe {

enum Bone {
  kHips,
  kChest,
  kHead,
  kLeftArm,
  kLeftForearm,
  kLeftHand,
  kRightArm,
  kRightForearm,
  kRightHand,
  kLeftThigh,
  kLeftShin,
  kLeftFoot,
  kRightThigh,
  kRightShin,
  kRightFoot,
  kNumBones
};

/// Rotation of each bone relative to its parent: about x, y, z, in this order [degrees].
using Pose = std::array<Vec3, kNumBones>;

enum class Hands { fingers, mittens };

/// The figure's skin at rest, for these bones only, joined over a length of `blend`, the torso over 0.06 or
/// more [m].
Field body_field(const std::vector<Bone>& bones, double blend, Hands hands = Hands::fingers);

/// Start of the bone at rest [m].
Vec3 joint_of(Bone bone);

/// "left_forearm"
std::string name_of(Bone bone);

/// The bone that it is attached to; the hips' is the hips.
Bone parent_of(Bone bone);

/// About fixed x, then y, then z.
Mat3 rotation_of(const Vec3& angles_deg);

struct Figure {
  TriangleMesh mesh;                                  // at rest; the hair comes last
  int num_skin_triangles = 0;                         // before the hair
  std::vector<std::array<float, kNumBones>> weights;  // (num_vertices) sums are 1 [1]
};

/// With cells of side `cell` [m]; 0.011 gives 15,000 vertices. Fingers need cells below that: else they merge
/// into edges of more than two triangles.
Figure make_figure(double cell, Hands hands = Hands::fingers);

/// The mesh's vertices in a pose (num_vertices) [m].
std::vector<Vec3> pose_figure(const Figure& figure, const Pose& pose);

/// A motion from rest: "stand" (arms sink a little), "walk", "stroll" (a calmer walk), "kick" (the foot reaches
/// 15 m/s), "fold" (the arms fold before the chest) or "sit". `time` [s].
Pose pose_at(const std::string& motion, double time);

}  // namespace weft::engine::wardrobe
