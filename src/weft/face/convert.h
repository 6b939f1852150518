#pragma once
/// Private to face/: conversions between public plain types and the engine's.

#include <string>
#include <vector>

#include "weft/animation/rigid_motion.h"
#include "weft/cloth.h"
#include "weft/collider.h"
#include "weft/contact/collider.h"
#include "weft/forces/wind.h"
#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

inline Vec3 to_engine(const weft::Vec3& v) { return {v.x, v.y, v.z}; }
inline weft::Vec3 from_engine(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

inline Mat3 to_engine(const weft::Mat3& m) {
  Mat3 result;
  result << m.row0.x, m.row0.y, m.row0.z, m.row1.x, m.row1.y, m.row1.z, m.row2.x, m.row2.y, m.row2.z;
  return result;
}
inline weft::Mat3 from_engine(const Mat3& m) {
  return {{m(0, 0), m(0, 1), m(0, 2)}, {m(1, 0), m(1, 1), m(1, 2)}, {m(2, 0), m(2, 1), m(2, 2)}};
}

inline Pose to_engine(const weft::Pose& p) { return {to_engine(p.translation), to_engine(p.rotation)}; }
inline weft::Pose from_engine(const Pose& p) { return {from_engine(p.translation), from_engine(p.rotation)}; }

inline std::vector<Vec3> to_engine(const std::vector<weft::Vec3>& points) {
  std::vector<Vec3> result;
  result.reserve(points.size());
  for (const weft::Vec3& p : points) result.push_back(to_engine(p));
  return result;
}
inline std::vector<weft::Vec3> from_engine(const std::vector<Vec3>& points) {
  std::vector<weft::Vec3> result;
  result.reserve(points.size());
  for (const Vec3& p : points) result.push_back(from_engine(p));
  return result;
}

RigidMotion to_engine(const std::vector<weft::KeyFrame>& keys,
                      const std::string& who);  // `who` begins errors
std::vector<weft::KeyFrame> from_engine(const std::vector<KeyFrame>& keys);
TriangleMesh to_engine(const weft::TriangleMesh& mesh);  // without texture coordinates
std::vector<CornerUv> to_engine(const std::vector<weft::CornerUv>& uv);
std::vector<weft::CornerUv> from_engine(const std::vector<CornerUv>& uv);

/// The public mesh, with texture coordinates if any (num_triangles or none).
weft::TriangleMesh from_engine(const TriangleMesh& mesh, const std::vector<CornerUv>& uv);

std::vector<WindKey> to_engine(const std::vector<weft::WindKey>& keys);
}  // namespace weft::engine
