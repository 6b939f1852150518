#pragma once
/// The cloths that integrators are measured on: flat and horizontal at rest, hung by two points, let go.

#include <memory>
#include <string>

#include "weft/integrators/integrator.h"

namespace weft::bench {

struct HungCloth {
  std::string name;
  std::shared_ptr<const ClothModel> model;
  ClothState state;
  Environment environment;
};

/// A square of 1 m hung by the corners of its first row. `springs`: basic, simplified, alternating, or "mesh"
/// for the same cloth as a triangle mesh; throws InputError for another name.
HungCloth make_hung_sheet(int particles_per_side, const std::string& springs, const ClothMaterial& material);

/// A disc of 1 m as a mesh of rings of 6, 12, 18, … particles around one, hung by two points of its rim a
/// quarter of it apart.
HungCloth make_hung_disc(int num_rings, const ClothMaterial& material);

}  // namespace weft::bench
