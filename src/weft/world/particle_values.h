#pragma once
/// Values of particles to show in colours.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "weft/world/world.h"

namespace weft::engine {

enum class ParticleValue {
  strain,   // the larger strain along warp or weft, of springs that of structural ones [%]
  shear,    // change of the angle between warp and weft [°]
  speed,    // [m/s]
  contact,  // force of all contacts of the last step over the particle's area, if contacts are tracked [Pa]
};

inline constexpr std::array kParticleValues = {ParticleValue::strain, ParticleValue::shear,
                                               ParticleValue::speed, ParticleValue::contact};

/// "strain", "strain of threads", "%".
struct ValueLabel {
  std::string word, name, unit;

  std::string text() const { return name + " [" + unit + "]"; }
};
ValueLabel label_of(ParticleValue value);

/// The value at each particle (num_particles): strain and shear are means over its triangles or springs.
/// Throws InputError for shear of a mesh of springs, which has no warp.
std::vector<float> compute_values(ParticleValue value, const World& world, ClothId cloth);

/// Warp and weft of a triangle as they are now. Their lengths are the stretches: length over rest length [1].
struct Yarns {
  Vec3 warp, weft;

  double warp_strain() const { return 100 * (warp.norm() - 1); }  // [%]
  double weft_strain() const { return 100 * (weft.norm() - 1); }  // [%]
  double shear() const;                                           // change of the angle between them [°]
};

/// Empty for cloth of springs, whose triangles have no yarns.
std::optional<Yarns> find_yarns(const ClothModel& model, const ClothState& state, int triangle);

}  // namespace weft::engine
