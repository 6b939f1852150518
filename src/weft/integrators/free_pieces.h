#pragma once
/// Private to integrators/: the pieces of a cloth that no pin holds.

#include <vector>

#include "weft/core/padded_rows.h"
#include "weft/core/vec3_array.h"
#include "weft/model/cloth_model.h"

namespace weft {

/// Pieces of cloth that hang together by springs or elements, without a pinned particle among them.
class FreePieces {
 public:
  void find(const ClothModel& model, const std::vector<int>& pinned);

  /// Something outside pushes the piece of this particle, until release(): its mean is left alone.
  void hold(int particle);
  void release();

  /// Takes from the displacements of each free piece their mean, weighted by `weight` (laid out by `rows`).
  void remove_mean(const PaddedRows& rows, const std::vector<float>& weight, Vec3Array& displacement);

 private:
  std::vector<int>
      piece_;  // of each particle, -1: pinned or tied to a pin; empty if there are no free pieces
  std::vector<Vec3> moment_;
  std::vector<double> weight_;
  std::vector<char> is_held_;
};

}  // namespace weft
