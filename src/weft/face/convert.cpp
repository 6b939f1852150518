#include "weft/face/convert.h"

namespace weft::engine {

std::vector<KeyFrame> to_engine(const std::vector<weft::KeyFrame>& keys) {
  std::vector<KeyFrame> result;
  for (const weft::KeyFrame& k : keys)
    result.push_back({k.time, to_engine(k.translation), to_engine(k.angles_deg)});
  return result;
}

std::vector<weft::KeyFrame> from_engine(const std::vector<KeyFrame>& keys) {
  std::vector<weft::KeyFrame> result;
  for (const KeyFrame& k : keys)
    result.push_back({k.time, from_engine(k.translation), from_engine(k.angles_deg)});
  return result;
}

TriangleMesh to_engine(const weft::TriangleMesh& mesh) { return {to_engine(mesh.positions), mesh.triangles}; }

std::vector<CornerUv> to_engine(const std::vector<weft::CornerUv>& uv) {
  std::vector<CornerUv> result;
  result.reserve(uv.size());
  for (const weft::CornerUv& corners : uv) {
    CornerUv& to = result.emplace_back();
    for (int c = 0; c < 3; ++c) to[c] = {corners[c][0], corners[c][1]};
  }
  return result;
}

weft::TriangleMesh from_engine(const TriangleMesh& mesh, const std::vector<CornerUv>& uv) {
  weft::TriangleMesh result{from_engine(mesh.positions), mesh.triangles, {}};
  for (const CornerUv& corners : uv) {
    weft::CornerUv& to = result.uv.emplace_back();
    for (int c = 0; c < 3; ++c) to[c] = {corners[c].x(), corners[c].y()};
  }
  return result;
}

std::vector<WindKey> to_engine(const std::vector<weft::WindKey>& keys) {
  std::vector<WindKey> result;
  for (const weft::WindKey& k : keys) result.push_back({k.time, to_engine(k.velocity)});
  return result;
}

}  // namespace weft::engine
