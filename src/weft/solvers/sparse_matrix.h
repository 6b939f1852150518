#pragma once
/// Sparse scalar matrices in compressed rows, for the setup of the mesh multigrid.

#include <vector>

namespace weft::engine {

struct SparseMatrix {
  int num_rows = 0, num_columns = 0;
  std::vector<int> begin = {0};  // (num_rows + 1) first entry of each row
  std::vector<int> column;       // of each entry; no two of a row are equal
  std::vector<double> value;     // of each entry

  void add_entry(int c, double v) {
    column.push_back(c);
    value.push_back(v);
  }
  void end_row() {
    begin.push_back(static_cast<int>(column.size()));
    ++num_rows;
  }
};

SparseMatrix transpose(const SparseMatrix& a);

/// A B. The entries of a row are in the order in which they first occur.
SparseMatrix multiply(const SparseMatrix& a, const SparseMatrix& b);

}  // namespace weft::engine
