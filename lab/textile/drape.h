#pragma once
/// One specimen of the drape test, and its measurements.

#include "lab/textile/specimen.h"
#include "weft/io/animation.h"

namespace weft::engine::lab {

struct Drape {
  double coefficient = 0;  // [1]
  int nodes = 0;           // folds [1]
  bool is_at_rest = true;  // at the end all speeds are below 1 mm/s
  Animation specimen;      // one frame
};

/// `seed` sets the initial creases of the specimen, which determine the positions of folds.
Drape simulate_drape(const Fabric& fabric, const SpecimenSettings& settings, std::uint64_t seed, int threads);

/// Area of the vertical shadow of triangles on the ground, overlaps counted once. The error is about a
/// millimetre times the outline [m²].
double compute_shadow(const std::vector<Triangle>& triangles, const ClothState& state);

/// A cloth as an animation of one frame.
Animation show_specimen(const ClothModel& model, const ClothState& state);

}  // namespace weft::engine::lab
