#pragma once
/// Test cloths for integrators: flat and horizontal at the start, hung by two points.

#include <memory>
#include <string>

#include "weft/integrators/integrator.h"

namespace weft::engine::lab {

struct HungCloth {
  std::string name;
  std::shared_ptr<const ClothModel> model;
  ClothState state;
  Environment environment;
};

/// A square of 1 m hung by the corners of its first row. `springs`: basic, simplified, alternating, or "mesh"
/// for the same cloth as a triangle mesh; throws InputError for another name.
HungCloth make_hung_sheet(int particles_per_side, const std::string& springs, const ClothMaterial& material);

/// A strip 1 m long with so many cells, hung by its first row, the short edge; `width` [m], 0: square cells.
HungCloth make_hung_strip(int cells_across, int cells_along, const ClothMaterial& material, double width = 0);

/// A disc of 1 m as a mesh of rings with 6, 12, 18, … particles around the centre, hung by two points of its
/// rim. They are a quarter of the rim apart.
HungCloth make_hung_disc(int num_rings, const ClothMaterial& material);

/// A free chain: particles at these positions [m], each of this mass [kg]. Structural springs of this rest
/// length [m] and stiffness [N/m] join neighbours.
HungCloth make_chain(const std::vector<Vec3>& places, double mass, double rest_length, double stiffness);

/// Root mean square distance of two sets of positions of equal size [m].
double rms_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b);

}  // namespace weft::engine::lab
