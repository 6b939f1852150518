#pragma once
/// Layout of a cloth's particles in the solver's arrays: rows padded with zeros between and around them, so
/// that stencils need no special case at the border. Cloth without a grid is one row.

#include <cstddef>

#include "weft/core/pack.h"

namespace weft::engine {

struct PaddedRows {
  static constexpr int kRowsAround = 2;  // above the first row and below the last one

  int row_length = 1;  // particles per row
  int num_rows = 0;

  int stride() const { return round_up_to_pack(row_length) + kPackLanes; }  // from one row to the next
  int row(int j) const { return (j + kRowsAround) * stride() + kPackLanes; }
  int index(int i) const { return row(i / row_length) + i % row_length; }
  int num_particles() const { return row_length * num_rows; }
  std::size_t size() const {
    return static_cast<std::size_t>(num_rows + 2 * kRowsAround) * stride() + kPackLanes;
  }

  bool operator==(const PaddedRows&) const = default;
};

}  // namespace weft::engine
