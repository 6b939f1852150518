#pragma once
/// Pieces of fabric as they are laid in testing machines.

#include <functional>

#include "weft/fabric.h"
#include "weft/integrators/integrator.h"
#include "weft/mesh/grid.h"

namespace weft::engine::lab {

enum class SpecimenMesh {
  grid,    // squares, cut along alternating diagonals
  random,  // see build_random_mesh
};

enum class SpecimenMembrane {
  triangle,  // elements
  springs,   // edges that stand for the fabric as well as they can
};

struct SpecimenSettings {
  SpecimenMesh mesh = SpecimenMesh::grid;
  int resolution = 0;  // cells along the specimen, or rings of a disc; 0: the test's own [1]
  SpecimenMembrane membrane = SpecimenMembrane::triangle;  // of tensile and shear tests
};

/// A piece of fabric without contact, and what acts on it.
struct Specimen {
  std::shared_ptr<const ClothModel> model;
  ClothState state;
  Environment environment{.gravity = Vec3::Zero()};

  const std::vector<Vec3>& rest() const { return model->topology->mesh.positions; }
};

struct RectangleOptions {
  double warp_deg = 0;  // warp is turned from x by so much; a multiple of 90° on a grid: a model of stencils
  int straight_column = 0;  // of a random mesh's grid: stays in line, to be clamped up to and bend over
  SpecimenMembrane membrane = SpecimenMembrane::triangle;  // springs on a grid: warp_deg = 0 alone
};

/// A rectangle in the x–z plane.
Specimen make_rectangle(const Fabric& fabric, const Grid& grid, SpecimenMesh mesh,
                        const RectangleOptions& options = {});

/// Holds every particle for which `place` gives a place, by its position at rest [m].
void clamp(Specimen& specimen, const std::function<std::optional<Vec3>(const Vec3&)>& place);

/// Takes a specimen of this size [m] to rest with newton: where its motion is fastest it is stopped (kinetic
/// damping), until nothing moves by more than a hundred-thousandth of the size in thirty steps. False if that
/// did not come in six thousand steps.
bool settle(Specimen& specimen, double size);

/// Internal force of the membranes, or of the springs, on each particle, in double precision (num_particles)
/// [N].
std::vector<Vec3> compute_membrane_forces(const Specimen& specimen);

}  // namespace weft::engine::lab
