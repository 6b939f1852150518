#pragma once
/// Specimens of fabric for simulated testing machines.

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
  springs,   // on edges: an approximation of the fabric
};

struct SpecimenSettings {
  SpecimenMesh mesh = SpecimenMesh::grid;
  int resolution = 0;  // cells along the specimen, or rings of a disc; 0: the test's own [1]
  SpecimenMembrane membrane = SpecimenMembrane::triangle;  // of tensile and shear tests
  double warp_deg = 0;  // of drape tests: direction of warp against the mesh [degrees]
};

/// A preset without hysteresis and set of bending.
Fabric find_elastic_fabric(std::string_view name);

/// A piece of fabric without contact, with its loads.
struct Specimen {
  std::shared_ptr<const ClothModel> model;
  ClothState state;
  Environment environment{.gravity = Vec3::Zero()};

  const std::vector<Vec3>& rest() const { return model->topology->mesh.positions; }
};

struct RectangleOptions {
  double warp_deg = 0;      // angle from x to warp; multiples of 90° on a grid use the grid's stencils
  int straight_column = 0;  // of a random mesh: this column stays straight, as the edge of a clamp
  SpecimenMembrane membrane = SpecimenMembrane::triangle;  // springs on a grid: only with warp_deg = 0
};

/// A rectangle in the x–z plane.
Specimen make_rectangle(const Fabric& fabric, const Grid& grid, SpecimenMesh mesh,
                        const RectangleOptions& options = {});

/// Pins every particle for which `place(rest position)` returns a target position [m].
void clamp(Specimen& specimen, const std::function<std::optional<Vec3>(const Vec3&)>& place);

/// Brings a specimen of this size [m] to rest with newton and kinetic damping: velocities are reset at maxima
/// of kinetic energy. At rest, nothing moves by more than a hundred-thousandth of the size in thirty steps.
/// False after six thousand steps.
bool settle(Specimen& specimen, double size);

/// Internal force of the membranes, or of the springs, on each particle, in double precision (num_particles)
/// [N].
std::vector<Vec3> compute_membrane_forces(const Specimen& specimen);

}  // namespace weft::engine::lab
