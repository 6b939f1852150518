#pragma once
/// Element tables of a mesh for vector registers, sixteen patches or particles per slice (see
/// kernels::MeshElements).

#include <vector>

#include "weft/core/aligned.h"
#include "weft/core/pack.h"
#include "weft/model/cloth_model.h"

namespace weft::engine {

struct ElementTables {
  std::vector<int> corner;
  AlignedFloats shape;
  std::vector<int> place_of_triangle;  // twice its patch, + 1 for the second triangle
  std::vector<int> slice_begin, neighbour, coupling;
  AlignedFloats bending;
  std::vector<int> far_begin, far_neighbour;
  AlignedFloats far_bending;

  int num_patch_slices() const { return static_cast<int>(corner.size()) / (4 * kPackLanes); }
  int num_slices() const { return slice_begin.empty() ? 0 : static_cast<int>(slice_begin.size()) - 1; }
  int num_entry_rows() const { return slice_begin.empty() ? 0 : slice_begin.back(); }
};

ElementTables build_element_tables(const ClothElements& elements, int num_particles);

}  // namespace weft::engine
