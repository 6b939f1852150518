#pragma once
/// One specimen of the drape test, and the measures that are taken of it.

#include "weft/io/animation.h"
#include "lab/textile/specimen.h"

namespace weft::engine::lab {

struct Drape {
  double coefficient = 0;  // [1]
  int nodes = 0;           // folds [1]
  bool is_at_rest = true;  // nothing moved by more than 1 mm/s at the end
  Animation specimen;      // one frame
};

/// `seed` chooses the creases of the specimen, which decide where folds come.
Drape simulate_drape(const Fabric& fabric, const SpecimenSettings& settings, std::uint64_t seed, int threads);

/// Area of the shadow that triangles throw on the ground in vertical light, overlaps once, to about a
/// millimetre times its outline [m²].
double compute_shadow(const std::vector<Triangle>& triangles, const ClothState& state);

/// A cloth as an animation of one frame.
Animation show_specimen(const ClothModel& model, const ClothState& state);

}  // namespace weft::engine::lab
