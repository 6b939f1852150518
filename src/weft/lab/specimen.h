#pragma once
/// Pieces of fabric as they are laid in testing machines.

#include <functional>

#include "weft/fabric/fabric.h"
#include "weft/integrators/integrator.h"
#include "weft/mesh/grid.h"

namespace weft {

enum class SpecimenMesh {
  grid,    // squares, cut along alternating diagonals
  random,  // see build_random_mesh
};

struct SpecimenSettings {
  SpecimenMesh mesh = SpecimenMesh::grid;
  int resolution = 0;  // cells along the specimen, or rings of a disc; 0: the test's own [1]
};

/// A piece of fabric without contact, and what acts on it.
struct Specimen {
  std::shared_ptr<const ClothModel> model;
  ClothState state;
  Environment environment{.gravity = Vec3::Zero()};

  const std::vector<Vec3>& rest() const { return model->topology->mesh.positions; }
};

/// A rectangle in the x–z plane. Warp is turned from x by `warp_deg`; a multiple of 90° on a grid makes a
/// model of stencils. Of a random mesh, this column of the grid stays in line, for the specimen to be clamped
/// up to and bend over; 0, as it is: none.
Specimen make_rectangle(const Fabric& fabric, const Grid& grid, SpecimenMesh mesh, double warp_deg,
                        int straight_column = 0);

/// Holds every particle for which `place` gives a place, by its position at rest [m].
void clamp(Specimen& specimen, const std::function<std::optional<Vec3>(const Vec3&)>& place);

/// Takes a specimen of this size [m] to rest with newton: where its motion is fastest it is stopped (kinetic
/// damping), until nothing moves by more than a hundred-thousandth of the size in thirty steps. False if that
/// did not come in six thousand steps.
bool settle(Specimen& specimen, double size);

/// Internal force of the membranes on each particle, in double precision (num_particles) [N].
std::vector<Vec3> compute_membrane_forces(const Specimen& specimen);

}  // namespace weft
