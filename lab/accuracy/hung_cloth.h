#pragma once
/// The cloths that integrators are measured on: flat and horizontal at rest, hung by two points, let go.

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

/// A strip 1 m long with that many cells, hung by its whole first row, which is short; `width` [m], 0: square
/// cells.
HungCloth make_hung_strip(int cells_across, int cells_along, const ClothMaterial& material, double width = 0);

/// A disc of 1 m as a mesh of rings of 6, 12, 18, … particles around one, hung by two points of its rim a
/// quarter of it apart.
HungCloth make_hung_disc(int num_rings, const ClothMaterial& material);

/// Particles at the given places [m], each of the given mass [kg], joined in a row by structural springs of
/// the given rest length [m] and stiffness [N/m]; nothing holds it.
HungCloth make_chain(const std::vector<Vec3>& places, double mass, double rest_length, double stiffness);

/// Where the particles are (num_particles) [m].
std::vector<Vec3> positions_of(const ClothState& state);

/// Root mean square distance of as many places [m].
double rms_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b);

}  // namespace weft::engine::lab
