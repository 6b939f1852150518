#include "weft/model/cloth_state.h"

#include <cmath>

namespace weft::engine {
namespace {

/// The origin lies on a lattice of this pitch [m]. Steps of a power of two make the subtraction exact for
/// every shrinking offset; only growing offsets (cloth parts nearer the old origin) are rounded again.
constexpr double kOriginPitch = 0.25;

/// Maximum distance of the cloth's centre from the origin before the origin moves [m].
constexpr double kMaxDrift = 2.0;

Vec3 round_to_lattice(const Vec3& p) { return (p / kOriginPitch).array().round().matrix() * kOriginPitch; }

/// Centre of the bounding box of the offsets.
Vec3 middle(const Vec3Array& x) {
  Vec3 low = x.get(0), high = x.get(0);
  for (std::size_t i = 1; i < x.size(); ++i) {
    low = low.cwiseMin(x.get(i));
    high = high.cwiseMax(x.get(i));
  }
  return (low + high) / 2;
}

}  // namespace

std::vector<Vec3> positions_of(const ClothState& state) {
  std::vector<Vec3> positions(state.x.size());
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = state.position(i);
  return positions;
}

ClothState make_state(const std::vector<Vec3>& positions) {
  ClothState state;
  Vec3 low = positions.front(), high = low;
  for (const Vec3& p : positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  state.origin = round_to_lattice((low + high) / 2);
  state.x.resize(positions.size());
  state.v.resize(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) state.set_position(i, positions[i]);
  return state;
}

Vec3 most_precise(const std::vector<Vec3>& precise, const Vec3Array& values, std::size_t i) {
  const Vec3 rounded = values.get(i);
  if (precise.empty() || precise[i].cast<float>().cast<double>() != rounded) return rounded;
  return precise[i];
}

void follow_cloth(ClothState& state) {
  const Vec3 drift = middle(state.x);
  if (!drift.allFinite() || drift.cwiseAbs().maxCoeff() < kMaxDrift) return;
  const Vec3 shift = round_to_lattice(drift);
  state.origin += shift;
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    const Vec3 x = most_precise(state.precise.x, state.x, i) - shift;
    state.x.set(i, x);
    if (!state.precise.x.empty()) state.precise.x[i] = x;
  }
}

void add_to_hash(const ClothState& state, Hash& hash) {
  const auto add = [&](const Vec3Array& values) {
    for (const float* component : {values.x(), values.y(), values.z()})
      hash.add(std::span<const float>(component, values.size()));
  };
  for (int c = 0; c < 3; ++c) hash.add(state.origin[c]);
  add(state.x);
  add(state.v);
  for (const auto* values : {&state.precise.x, &state.precise.v}) {
    for (const Vec3& value : *values) {
      for (const double component : value) hash.add(component);
    }
  }
  hash.add(std::span<const float>(state.bending.slip));
  hash.add(std::span<const float>(state.bending.set));
  if (state.seam_time > 0) hash.add(state.seam_time);
  for (const CaughtParticle& p : state.caught) {
    hash.add(static_cast<double>(p.particle));
    for (const HoldingSide& side : p.sides) {
      for (const int number : {side.collider, side.face, side.is_back ? 1 : 0})
        hash.add(static_cast<double>(number));
    }
  }
  const MotionHistory& history = state.history;
  if (history.step == 0) return;
  hash.add(history.step);
  hash.add(history.had_contact ? 1.0 : 0.0);
  add(history.displacement);
  add(history.velocity);
  hash.add(std::span<const float>(history.pressed.last));
  hash.add(std::span<const float>(history.pressed.lasting));
}

}  // namespace weft::engine
