#pragma once
/// Values of particles to show in colours.

#include <string>
#include <vector>

#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

enum class ParticleValue {
  strain,  // the larger strain along warp or weft, of springs that of structural ones [%]
  shear,   // change of the angle between warp and weft [°]
  speed,   // [m/s]
};

/// "strain of threads", and "%".
struct ValueLabel {
  std::string name, unit;
};
ValueLabel label_of(ParticleValue value);

/// The value at each particle (num_particles): means over its triangles or springs. Throws InputError for
/// shear of a mesh of springs, which has no warp.
std::vector<float> compute_values(ParticleValue value, const ClothModel& model, const ClothState& state);

}  // namespace weft::engine
