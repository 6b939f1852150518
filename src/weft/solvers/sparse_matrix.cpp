#include "weft/solvers/sparse_matrix.h"

namespace weft::engine {

SparseMatrix transpose(const SparseMatrix& a) {
  SparseMatrix t;
  t.num_rows = a.num_columns;
  t.num_columns = a.num_rows;
  t.begin.assign(a.num_columns + 1, 0);
  for (const int c : a.column) ++t.begin[c + 1];
  for (int r = 0; r < t.num_rows; ++r) t.begin[r + 1] += t.begin[r];
  t.column.resize(a.column.size());
  t.value.resize(a.value.size());
  std::vector<int> next(t.begin.begin(), t.begin.end() - 1);
  for (int r = 0; r < a.num_rows; ++r) {
    for (int e = a.begin[r]; e < a.begin[r + 1]; ++e) {
      const int to = next[a.column[e]]++;
      t.column[to] = r;
      t.value[to] = a.value[e];
    }
  }
  return t;
}

SparseMatrix multiply(const SparseMatrix& a, const SparseMatrix& b) {
  SparseMatrix c;
  c.num_columns = b.num_columns;
  std::vector<int> place(b.num_columns, -1);  // entry of the column, valid if not before the row's first
  for (int r = 0; r < a.num_rows; ++r) {
    const int first = c.begin.back();
    for (int e = a.begin[r]; e < a.begin[r + 1]; ++e) {
      for (int f = b.begin[a.column[e]]; f < b.begin[a.column[e] + 1]; ++f) {
        const double v = a.value[e] * b.value[f];
        int& at = place[b.column[f]];
        if (at < first) {
          at = static_cast<int>(c.column.size());
          c.add_entry(b.column[f], v);
        } else {
          c.value[at] += v;
        }
      }
    }
    c.end_row();
  }
  return c;
}

}  // namespace weft::engine
