#pragma once
/// Inverse of a small dense matrix, for the coarsest level of a multigrid.

#include <vector>

namespace weft::engine {

/// Replaces a symmetric positive semidefinite n × n matrix, stored by rows, by its inverse. Zero rows, and
/// rows of which elimination leaves only rounding, get an inverse of zero.
void invert_in_place(std::vector<double>& matrix, int n);

}  // namespace weft::engine
