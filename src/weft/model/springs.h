#pragma once
/// Springs between particles: the paper's models on grids, and their counterpart on triangle meshes.
///
///   basic (Provot)        simplified (the paper)     alternating
///   o---o---o             o---o---o                  o---o---o
///   | X | X |             | \ | \ |                  | \ | / |
///   o---o---o             o---o---o                  o---o---o
///   | X | X |             | \ | \ |                  | / | \ |
///   o---o---o             o---o---o                  o---o---o
///
/// plus, in all three, bending springs to the particles two away along rows and columns. A triangulated
/// mesh's edges are exactly "structural + one shear". On meshes, therefore, every edge is a structural spring
/// and a bending spring joins the two vertices opposite to each inner edge; the model makes no difference.

#include <string_view>
#include <vector>

#include "weft/cloth.h"
#include "weft/mesh/grid.h"
#include "weft/mesh/rest_mesh.h"

namespace weft::engine {

enum class SpringKind { structural, shear, bend };
std::string_view to_string(SpringModel model);

struct Spring {
  int i = 0, j = 0;  // particles
  SpringKind kind = SpringKind::structural;
  double rest_length = 0;  // [m]
};

/// Triangle diagonals of a model (`basic` has both springs; its triangles alternate).
GridDiagonals diagonals_of(SpringModel model);

std::vector<Spring> build_grid_springs(const Grid& grid, SpringModel model);
std::vector<Spring> build_mesh_springs(const RestMesh& mesh);

}  // namespace weft::engine
