#pragma once
/// A cloth's constants: material and topology. Its variables are in ClothState.
///
/// Topology changes only where cloth tears (torn_cloth.h). Material numbers (mass, stiffness, damping) may be replaced
/// between any two steps: that creates a new ClothModel on the same ClothTopology, and recomputes only numbers.

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "weft/mesh/grid.h"
#include "weft/mesh/rest_mesh.h"
#include "weft/model/cloth_elements.h"
#include "weft/model/gas.h"
#include "weft/model/neighbour_table.h"
#include "weft/model/seams.h"
#include "weft/model/springs.h"

namespace weft::engine {

/// Material of a cloth made of springs.
struct ClothMaterial {
  double density = 0.2;      // mass per area, > 0 [kg/m²]
  double structural = 2000;  // stiffness of structural springs, >= 0 [N/m]
  double shear = 1000;       // of shear springs, >= 0; not used on meshes [N/m]
  double bend = 20;          // of bending springs, >= 0 [N/m]
  double damping = 0;        // of every spring, >= 0 [N·s/m]
  DampingKind damping_kind = DampingKind::projected;
  double thickness = 1e-3;  // distance between layers; half of it to colliders, >= 0 [m]
  double friction = 0.3;    // Coulomb coefficient of cloth on cloth, >= 0 [1]

  // Springs that represent a fabric (see make_grid_springs, make_mesh_springs); supported by the integrators
  // that support elements.
  std::optional<double> structural_z;  // of a grid's structural springs along the second axis; those on the
                                       // border, of both axes, then have half their stiffness [N/m]
  double damping_time = 0;             // τ: additional damping τ k of every spring of stiffness k, >= 0 [s]

  /// Multiplier of each spring's stiffness, in the topology's order, >= 0; empty: 1.
  std::vector<double> spring_factors;
  bool operator==(const ClothMaterial&) const = default;
};

struct ClothTopology {
  RestMesh mesh;
  std::vector<Spring> springs;  // every spring once
  std::vector<double> area;     // of each particle (num_particles) [m²]
  std::optional<Grid> grid;     // set: the fast kernels use stencils, not `table`
  SpringModel spring_model = SpringModel::simplified;
  NeighbourTable table;  // the springs around each particle; empty on grids
  Seams seams;           // of a mesh's panels

  int num_particles() const { return mesh.num_vertices(); }
};

/// Throws InputError for an invalid grid.
std::shared_ptr<const ClothTopology> build_grid_topology(const Grid& grid, SpringModel model);

/// The mesh must be clean (see clean_mesh). Throws InputError for an invalid mesh.
std::shared_ptr<const ClothTopology> build_mesh_topology(RestMesh mesh, Seams seams = {});

struct ClothModel {
  std::uint64_t id = 0;  // unique in the process: a cache key for data computed from a model without `gas`
  std::shared_ptr<const ClothTopology> topology;
  ClothMaterial material;
  /// A fabric's membranes and bending, or only bending where springs replace membranes; null: none. Supported
  /// by `newton`, `implicit_euler` and `xpbd`.
  std::shared_ptr<const ClothElements> elements;
  Gas gas;                             // inside closed cloth
  std::vector<double> mass;            // (num_particles) [kg]
  std::vector<double> stiffness_sum;   // Σ_j k_ij of springs and couplings, (num_particles) [N/m]
  NeighbourTable own_table;            // of a grid whose springs have factors; else empty
  std::vector<float> entry_stiffness;  // k of each entry of table(), 0 in its padding [N/m]
  double max_stiffness_rate = 0;       // max_i Σ_j k_ij / m_i [1/s²]
  double max_damping_rate = 0;         // max_i Σ_j d_ij / m_i [1/s]

  int num_particles() const { return topology->num_particles(); }

  /// Whether all springs of a direction are equal: on a grid without factors.
  bool has_equal_springs() const { return topology->grid && material.spring_factors.empty(); }

  /// Springs around each particle; empty if all of a direction are equal.
  const NeighbourTable& table() const { return topology->grid ? own_table : topology->table; }

  /// Stiffness by spring kind, before factors [N/m].
  double stiffness(SpringKind kind) const {
    switch (kind) {
      case SpringKind::structural:
        return material.structural;
      case SpringKind::shear:
        return material.shear;
      case SpringKind::bend:
        break;
    }
    return material.bend;
  }

  double stiffness(int spring) const;  // of a spring of the topology [N/m]
  double damping(int spring) const {   // [N·s/m]
    return material.damping + material.damping_time * stiffness(spring);
  }
};

/// Throws InputError for a number of spring factors other than that of springs, or a factor that is negative
/// or not finite.
std::shared_ptr<const ClothModel> build_cloth_model(std::shared_ptr<const ClothTopology> topology,
                                                    const ClothMaterial& material,
                                                    std::shared_ptr<const ClothElements> elements = nullptr);

/// The same cloth with another gas.
std::shared_ptr<const ClothModel> with_gas(const ClothModel& model, const Gas& gas);

/// The same cloth with masses increased by `added` (num_particles) [kg].
std::shared_ptr<const ClothModel> build_heavier_model(const ClothModel& model,
                                                      const std::vector<double>& added);

}  // namespace weft::engine
