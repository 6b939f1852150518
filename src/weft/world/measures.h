#pragma once
/// Measures of a cloth: energies, momentum, strain. In double precision, independent of the integrator's
/// precision.

#include <optional>

#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

double compute_kinetic_energy(const ClothModel& model, const ClothState& state);  // [J]

/// Energy of all springs and elements, and of gas [J].
double compute_elastic_energy(const ClothModel& model, const ClothState& state);

/// The same energy in its two parts.
struct ElasticParts {
  double stretch = 0;  // of structural and shear springs, membranes, strain limits, seams, gas [J]
  double bending = 0;  // of bending springs, curvature stencils and hinges [J]
};
ElasticParts compute_elastic_parts(const ClothModel& model, const ClothState& state);

/// Volume inside closed cloth, as its gas has it: positive unless the cloth is inside out [m³].
double compute_volume(const ClothModel& model, const ClothState& state);

/// −Σ m g·x, zero with all mass at the world's origin [J].
double compute_gravity_energy(const ClothModel& model, const ClothState& state, const Vec3& gravity);

Vec3 compute_momentum(const ClothModel& model, const ClothState& state);  // Σ m v [kg·m/s]

/// Σ m (x − point) × v [kg·m²/s].
Vec3 compute_angular_momentum(const ClothModel& model, const ClothState& state, const Vec3& point);

Vec3 compute_center_of_mass(const ClothModel& model, const ClothState& state);  // [m]

/// What is shorter at rest has no meaningful strain: a tenth of the cloth's thickness [m]. Edges that are shorter, and
/// triangles with a smaller height, do not count below. Slivers of garments are such, and contact moves them by more.
double measurable_length(const ClothModel& model);

/// l/l0 − 1 over the structural springs: the mesh's edges, without grid diagonals and bending springs [1].
struct Strain {
  double min = 0, max = 0, mean = 0;
};
Strain compute_strain(const ClothModel& model, const ClothState& state);

/// Principal stretches: the smallest and largest ratio of present to rest length of any direction in any
/// membrane triangle; empty for cloth of springs only [1].
struct Stretches {
  double min = 0, max = 0;
};
std::optional<Stretches> compute_principal_stretches(const ClothModel& model, const ClothState& state);

/// The largest strain along warp, weft or a structural spring, and a particle of it. Shear of membranes does
/// not count, nor does the stretch of the given shape where cloth is shorter at rest, as elastic is [1].
struct YarnStrain {
  double max = 0;
  int particle = -1;
};
YarnStrain compute_yarn_strain(const ClothModel& model, const ClothState& state);

/// The smallest area of a triangle over its rest area, and a particle of it [1].
struct AreaShare {
  double min = 0;
  int particle = -1;
};
AreaShare compute_least_area(const ClothModel& model, const ClothState& state);

double compute_lowest_y(const ClothState& state);  // [m]

}  // namespace weft::engine
