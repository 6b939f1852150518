#include "tools/wardrobe/figure.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "weft/core/angle.h"

namespace weft::engine::wardrobe {
namespace {

/// A round cone: the union of balls from a to b, with radius from ra to rb [m].
struct Cone {
  Bone bone;
  Vec3 a, b;
  double ra, rb;
};

constexpr double kTorso = 0.06;  // blend length of its parts [m]
constexpr double kArmSlope_deg = 30;
const Vec3 kShoulder{0.18, 1.40, -0.01};

/// A point at the left arm: distance from the shoulder, and offsets in front of and above the arm [m].
Vec3 along_arm(double length, double front = 0, double up = 0) {
  const auto [sin, cos] = sin_cos_deg(kArmSlope_deg);
  return kShoulder + Vec3(cos * length + sin * up, -sin * length + cos * up, front);
}

std::vector<Cone> make_left_side() {
  std::vector<Cone> cones = {
      {kHips, {0.085, 0.94, 0}, {0.05, 1.10, 0}, 0.100, 0.088},
      {kHips, {0.075, 0.93, -0.05}, {0.07, 0.90, -0.05}, 0.075, 0.075},
      {kChest, {0.05, 1.10, 0}, {0.075, 1.29, 0}, 0.088, 0.098},
      {kChest, {0.075, 1.25, 0.06}, {0.07, 1.29, 0.05}, 0.055, 0.050},
      {kChest, {0, 1.43, -0.01}, {0.16, 1.395, -0.01}, 0.060, 0.055},
      {kLeftArm, along_arm(0), along_arm(0.28), 0.052, 0.040},
      {kLeftForearm, along_arm(0.28), along_arm(0.53), 0.040, 0.028},
      {kLeftHand, along_arm(0.53), along_arm(0.62), 0.028, 0.026},
      {kLeftHand, along_arm(0.56, 0.02), along_arm(0.62, 0.055), 0.014, 0.012},  // thumb
      {kLeftThigh, {0.09, 0.92, 0}, {0.10, 0.50, 0.01}, 0.085, 0.056},
      {kLeftShin, {0.10, 0.50, 0.01}, {0.10, 0.09, -0.02}, 0.054, 0.036},
      {kLeftShin, {0.10, 0.40, -0.02}, {0.10, 0.32, -0.025}, 0.054, 0.048},  // calf
      {kLeftFoot, {0.10, 0.055, -0.03}, {0.12, 0.035, 0.14}, 0.042, 0.032},
  };
  for (const double front : {-0.026, -0.009, 0.009, 0.026})  // fingers
    cones.push_back({kLeftHand, along_arm(0.63, front), along_arm(0.71, 1.3 * front), 0.011, 0.009});
  return cones;
}

std::vector<Cone> make_cones() {
  std::vector<Cone> cones = {
      {kChest, {0, 1.30, -0.01}, {0, 1.46, -0.01}, 0.09, 0.06},
      {kHead, {0, 1.46, -0.01}, {0, 1.56, 0.005}, 0.055, 0.052},
      {kHead, {0, 1.60, 0.02}, {0, 1.68, 0.01}, 0.072, 0.090},
      {kHead, {0, 1.64, 0.10}, {0, 1.62, 0.108}, 0.008, 0.012},  // nose
  };
  for (Cone cone : make_left_side()) {
    cones.push_back(cone);
    if (cone.bone > kHead) cone.bone = static_cast<Bone>(cone.bone + 3);
    for (Vec3* end : {&cone.a, &cone.b}) end->x() = -end->x();
    cones.push_back(cone);
  }
  return cones;
}

const std::vector<Cone>& all_cones() {
  static const std::vector<Cone> cones = make_cones();
  return cones;
}

double distance_to(const Cone& cone, const Vec3& p) {
  const Vec3 axis = cone.b - cone.a;
  const double t = axis.isZero() ? 0 : std::clamp((p - cone.a).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
  return (p - cone.a - t * axis).norm() - (cone.ra + t * (cone.rb - cone.ra));
}

/// The polynomial smooth minimum of Quilez.
double smooth_min(double a, double b, double blend) {
  const double h = std::max(blend - std::abs(a - b), 0.0) / blend;
  return std::min(a, b) - h * h * blend / 4;
}

double hair_field(const Vec3& p) {
  const double shell = distance_to({kHead, {0, 1.58, -0.045}, {0, 1.685, 0.0}, 0.08, 0.108}, p);
  const double face = p.z() - 0.035 + 0.4 * (1.70 - p.y());
  return -smooth_min(-shell, -face, 0.03);
}

constexpr std::array<Bone, kNumBones> kParent = {
    kHips,         kHips, kChest,     kChest,    kLeftArm, kLeftForearm, kChest,    kRightArm,
    kRightForearm, kHips, kLeftThigh, kLeftShin, kHips,    kRightThigh,  kRightShin};

/// Skinning weights, which decrease with the distance to each bone's skin.
std::array<float, kNumBones> compute_weights(const Vec3& p) {
  constexpr double kReach = 0.014;  // [m]
  std::array<double, kNumBones> distance;
  distance.fill(1);
  for (const Cone& cone : all_cones())
    distance[cone.bone] = std::min(distance[cone.bone], distance_to(cone, p));
  const double least = *std::min_element(distance.begin(), distance.end());
  double sum = 0;
  for (double& d : distance) sum += d = std::exp((least - d) / kReach);
  std::array<float, kNumBones> weights{};
  for (int b = 0; b < kNumBones; ++b) weights[b] = static_cast<float>(distance[b] / sum);
  return weights;
}

double to_rad(double angle_deg) { return angle_deg * 0.017453292519943295; }

/// 0 before `begin`, 1 after `end`, smooth between.
double ramp(double time, double begin, double end) {
  const double t = std::clamp((time - begin) / (end - begin), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

Pose rest_pose() {
  Pose pose;
  pose.fill(Vec3::Zero());
  return pose;
}

/// Rotates both arms down, by the same angle.
void lower_arms(Pose& pose, double angle_deg) {
  pose[kLeftArm].z() = -angle_deg;
  pose[kRightArm].z() = angle_deg;
}

Pose stand(double time) {
  Pose pose = rest_pose();
  lower_arms(pose, 12 * ramp(time, 0, 0.5));
  return pose;
}

Pose walk(double time) {
  Pose pose = rest_pose();
  const double swing = ramp(time, 0, 0.4) * std::sin(2 * 3.141592653589793 * time);
  lower_arms(pose, 40 * ramp(time, 0, 0.6));
  pose[kLeftThigh].x() = -28 * swing;
  pose[kRightThigh].x() = 28 * swing;
  pose[kLeftShin].x() = 12 + 30 * std::max(-swing, 0.0);
  pose[kRightShin].x() = 12 + 30 * std::max(swing, 0.0);
  for (const Bone shin : {kLeftShin, kRightShin}) pose[shin].x() *= ramp(time, 0, 0.4);
  pose[kLeftArm].y() = -18 * swing;
  pose[kRightArm].y() = -18 * swing;
  pose[kChest].y() = 8 * swing;
  return pose;
}

Pose stroll(double time) {
  Pose pose = rest_pose();
  const double start = ramp(time, 0, 0.8);
  const double swing = start * std::sin(2 * 3.141592653589793 * 0.9 * time);
  lower_arms(pose, 18 * start);
  pose[kLeftThigh].x() = -20 * swing;
  pose[kRightThigh].x() = 20 * swing;
  pose[kLeftShin].x() = 6 * start + 22 * std::max(-swing, 0.0);
  pose[kRightShin].x() = 6 * start + 22 * std::max(swing, 0.0);
  pose[kLeftArm].y() = -10 * swing;
  pose[kRightArm].y() = -10 * swing;
  pose[kHips].y() = -4 * swing;
  pose[kChest].y() = 9 * swing;
  return pose;
}

/// The leg goes back, the knee bends, then both snap.
Pose kick(double time) {
  Pose pose = rest_pose();
  const double back = ramp(time, 0, 0.3), snap = ramp(time, 0.33, 0.53), down = ramp(time, 0.65, 1.0);
  pose[kRightThigh].x() = 30 * back - 125 * snap + 95 * down;
  pose[kRightShin].x() = 70 * back - 65 * ramp(time, 0.38, 0.56) - 5 * down;
  pose[kChest].x() = 8 * back - 14 * snap + 6 * down;
  pose[kLeftArm].y() = -25 * snap;
  pose[kRightArm].y() = -25 * snap;
  return pose;
}

Pose fold(double time) {
  Pose pose = rest_pose();
  const double close = ramp(time, 0, 0.7);
  lower_arms(pose, 35 * close);
  pose[kLeftArm].y() = -38 * close;
  pose[kRightArm].y() = 38 * close;
  pose[kLeftForearm].y() = -95 * close;
  pose[kRightForearm].y() = 95 * close;
  pose[kLeftForearm].z() = 12 * close;
  pose[kRightForearm].z() = 6 * close;
  return pose;
}

Pose sit(double time) {
  Pose pose = rest_pose();
  const double down = ramp(time, 0, 0.9);
  lower_arms(pose, 30 * down);
  for (const Bone thigh : {kLeftThigh, kRightThigh}) pose[thigh].x() = -88 * down;
  for (const Bone shin : {kLeftShin, kRightShin}) pose[shin].x() = 86 * down;
  return pose;
}

}  // namespace

Field body_field(const std::vector<Bone>& bones, double blend) {
  std::vector<Cone> cones;
  for (const Cone& cone : all_cones()) {
    if (std::find(bones.begin(), bones.end(), cone.bone) != bones.end()) cones.push_back(cone);
  }
  return [cones, blend](const Vec3& p) {
    double distance = 1;
    for (const Cone& cone : cones)
      distance =
          smooth_min(distance, distance_to(cone, p), cone.bone < kHead ? std::max(blend, kTorso) : blend);
    return distance;
  };
}

Vec3 joint_of(Bone bone) {
  switch (bone) {
    case kHips:
      return {0, 0.94, 0};
    case kChest:
      return {0, 1.12, 0};
    case kHead:
      return {0, 1.49, -0.01};
    default:
      break;
  }
  for (const Cone& cone : all_cones()) {
    if (cone.bone == bone) return cone.a;
  }
  return Vec3::Zero();
}

std::string name_of(Bone bone) {
  constexpr std::array<const char*, kNumBones> kNames = {
      "hips",      "chest",     "head",          "left_arm",   "left_forearm",
      "left_hand", "right_arm", "right_forearm", "right_hand", "left_thigh",
      "left_shin", "left_foot", "right_thigh",   "right_shin", "right_foot"};
  return kNames[bone];
}

Bone parent_of(Bone bone) { return kParent[bone]; }

Mat3 rotation_of(const Vec3& angles_deg) {
  return (Eigen::AngleAxisd(to_rad(angles_deg.z()), Vec3::UnitZ()) *
          Eigen::AngleAxisd(to_rad(angles_deg.y()), Vec3::UnitY()) *
          Eigen::AngleAxisd(to_rad(angles_deg.x()), Vec3::UnitX()))
      .toRotationMatrix();
}

Figure make_figure(double cell) {
  std::vector<Bone> bones;
  for (int b = 0; b < kNumBones; ++b) bones.push_back(static_cast<Bone>(b));
  Figure figure;
  figure.mesh = build_isosurface(body_field(bones, 0.02),
                                 Eigen::AlignedBox3d(Vec3(-0.95, -0.1, -0.25), Vec3(0.95, 1.85, 0.25)), cell);
  figure.num_skin_triangles = figure.mesh.num_triangles();
  append(figure.mesh,
         build_isosurface(hair_field, Eigen::AlignedBox3d(Vec3(-0.2, 1.35, -0.25), Vec3(0.2, 1.85, 0.25)),
                          cell));
  for (const Vec3& p : figure.mesh.positions) figure.weights.push_back(compute_weights(p));
  return figure;
}

std::vector<Vec3> pose_figure(const Figure& figure, const Pose& pose) {
  std::array<Mat3, kNumBones> turn;
  std::array<Vec3, kNumBones> shift;  // x → turn x + shift
  for (int b = 0; b < kNumBones; ++b) {
    const Vec3 joint = joint_of(static_cast<Bone>(b));
    const Mat3 own = rotation_of(pose[b]);
    const Mat3 before = b == kHips ? Mat3(Mat3::Identity()) : turn[kParent[b]];
    const Vec3 place = b == kHips ? joint : Vec3(before * joint + shift[kParent[b]]);
    turn[b] = before * own;
    shift[b] = place - turn[b] * joint;
  }
  std::vector<Vec3> posed;
  for (std::size_t v = 0; v < figure.weights.size(); ++v) {
    Vec3 sum = Vec3::Zero();
    for (int b = 0; b < kNumBones; ++b)
      sum += figure.weights[v][b] * (turn[b] * figure.mesh.positions[v] + shift[b]);
    posed.push_back(sum);
  }
  return posed;
}

Pose pose_at(const std::string& motion, double time) {
  if (motion == "walk") return walk(time);
  if (motion == "stroll") return stroll(time);
  if (motion == "kick") return kick(time);
  if (motion == "fold") return fold(time);
  if (motion == "sit") return sit(time);
  return stand(time);
}

}  // namespace weft::engine::wardrobe
