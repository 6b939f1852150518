#pragma once
/// The inverse of a small dense matrix, for the coarsest level of a multigrid.

#include <vector>

namespace weft::engine {

/// Replaces a symmetric positive semidefinite n × n matrix, row by row, by its inverse. Rows that hold
/// nothing, or nothing but rounding after the others are eliminated, get an inverse of zero.
void invert_in_place(std::vector<double>& matrix, int n);

}  // namespace weft::engine
