#pragma once
/// Vectors, rotations and poses, as plain numbers. weft/eigen.h converts them to Eigen's types.
///
/// The world is right-handed with y up. Lengths are in metres.

#include "weft/export.h"

namespace weft {

struct Vec3 {
  double x = 0, y = 0, z = 0;
  bool operator==(const Vec3&) const = default;
};

constexpr Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
constexpr double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
WEFT_API double length(const Vec3& a);

/// Rows of a 3×3 matrix; the default is the identity.
struct Mat3 {
  Vec3 row0 = {1, 0, 0}, row1 = {0, 1, 0}, row2 = {0, 0, 1};
  bool operator==(const Mat3&) const = default;
};

constexpr Vec3 operator*(const Mat3& m, const Vec3& p) {
  return {dot(m.row0, p), dot(m.row1, p), dot(m.row2, p)};
}

/// Rotation about an axis of any length > 0 [degrees]. Throws InputError for an axis of length 0.
WEFT_API Mat3 rotation_about(const Vec3& axis, double angle_deg);

/// Rotation about the fixed x axis, then y, then z, as in scene files [degrees].
WEFT_API Mat3 rotation_from_angles_deg(const Vec3& angles_deg);

/// Rotation of a quaternion of any length > 0. Throws InputError for one of length 0.
WEFT_API Mat3 rotation_from_quaternion(double w, double x, double y, double z);

/// From a shape's own coordinates to the world: p ↦ rotation p + translation.
struct Pose {
  Vec3 translation = {};  // [m]
  Mat3 rotation = {};     // columns perpendicular, of length 1, right-handed to 1e-6 [1]
};

}  // namespace weft
