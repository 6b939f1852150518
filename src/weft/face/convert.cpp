#include "weft/face/convert.h"

#include <utility>

#include "weft/error.h"

namespace weft::engine {

RigidMotion to_engine(const std::vector<weft::KeyFrame>& keys, const std::string& who) {
  std::vector<KeyFrame> result;
  for (const weft::KeyFrame& k : keys)
    result.push_back({k.time, to_engine(k.translation), to_engine(k.angles_deg)});
  try {
    return RigidMotion(std::move(result));
  } catch (const InputError& error) {
    throw InputError(who + error.what());
  }
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

std::vector<weft::CornerUv> from_engine(const std::vector<CornerUv>& uv) {
  std::vector<weft::CornerUv> result;
  result.reserve(uv.size());
  for (const CornerUv& corners : uv) {
    weft::CornerUv& to = result.emplace_back();
    for (int c = 0; c < 3; ++c) to[c] = {corners[c].x(), corners[c].y()};
  }
  return result;
}

weft::TriangleMesh from_engine(const TriangleMesh& mesh, const std::vector<CornerUv>& uv) {
  return {from_engine(mesh.positions), mesh.triangles, from_engine(uv)};
}

std::vector<WindKey> to_engine(const std::vector<weft::WindKey>& keys) {
  std::vector<WindKey> result;
  for (const weft::WindKey& k : keys) result.push_back({k.time, to_engine(k.velocity)});
  return result;
}

}  // namespace weft::engine
