#pragma once
/// Aggregates of neighbouring particles, for the coarser levels of AggregationMultigrid.

#include <vector>

#include "weft/solvers/sparse_matrix.h"

namespace weft::engine {

struct Aggregates {
  std::vector<int> of;  // aggregate of each particle, -1: none
  int count = 0;
};

/// Joins particles along strong couplings: those of at least a quarter of the strongest of either end.
/// Particles without couplings, or with a zero diagonal, are in none.
Aggregates find_aggregates(const SparseMatrix& couplings, const std::vector<double>& diagonal);

}  // namespace weft::engine
