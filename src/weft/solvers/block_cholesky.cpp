#include "weft/solvers/block_cholesky.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "weft/core/simd.h"

namespace weft::engine {
namespace {

#if defined(__GNUC__)
// A column of a block, for any machine and any register width.
typedef double Column __attribute__((vector_size(32), aligned(8), may_alias));
#else
struct Column {
  double value[4];
  friend Column operator*(const Column& a, double s) {
    return {{a.value[0] * s, a.value[1] * s, a.value[2] * s, a.value[3] * s}};
  }
  friend Column operator+(const Column& a, const Column& b) {
    return {
        {a.value[0] + b.value[0], a.value[1] + b.value[1], a.value[2] + b.value[2], a.value[3] + b.value[3]}};
  }
  friend Column operator-(const Column& a, const Column& b) { return a + b * -1.0; }
};
#endif

/// For the blocks b = 0 … count-1 of one column of L: y[row[b]] −= L_b X.
WEFT_ALWAYS_INLINE void subtract_column_body(const double* blocks, const int* rows, std::size_t count,
                                             const double* x, double* y) {
  const double x00 = x[0], x10 = x[1], x20 = x[2], x01 = x[4], x11 = x[5], x21 = x[6];
  const double x02 = x[8], x12 = x[9], x22 = x[10];
  for (std::size_t b = 0; b < count; ++b) {
    const Column* l = reinterpret_cast<const Column*>(blocks + 12 * b);
    Column* target = reinterpret_cast<Column*>(y + 12 * static_cast<std::size_t>(rows[b]));
    const Column l0 = l[0], l1 = l[1], l2 = l[2];
    target[0] = target[0] - (l0 * x00 + l1 * x10 + l2 * x20);
    target[1] = target[1] - (l0 * x01 + l1 * x11 + l2 * x21);
    target[2] = target[2] - (l0 * x02 + l1 * x12 + l2 * x22);
  }
}

WEFT_MULTIVERSION(subtract_column,
                  (const double* blocks, const int* rows, std::size_t count, const double* x, double* y),
                  (blocks, rows, count, x, y))

/// Inverse of the lower Cholesky factor of a 3×3 matrix; false if it is not positive definite.
bool invert_cholesky_factor(const Mat3& a, Mat3& inverse) {
  const double d0 = a(0, 0);
  if (!(d0 > 0)) return false;
  const double l00 = std::sqrt(d0), l10 = a(1, 0) / l00, l20 = a(2, 0) / l00;
  const double d1 = a(1, 1) - l10 * l10;
  if (!(d1 > 0)) return false;
  const double l11 = std::sqrt(d1), l21 = (a(2, 1) - l20 * l10) / l11;
  const double d2 = a(2, 2) - l20 * l20 - l21 * l21;
  if (!(d2 > 0) || !std::isfinite(d2)) return false;
  const double l22 = std::sqrt(d2);
  inverse.setZero();
  inverse(0, 0) = 1 / l00;
  inverse(1, 1) = 1 / l11;
  inverse(2, 2) = 1 / l22;
  inverse(1, 0) = -l10 * inverse(0, 0) / l11;
  inverse(2, 1) = -l21 * inverse(1, 1) / l22;
  inverse(2, 0) = -(l20 * inverse(0, 0) + l21 * inverse(1, 0)) / l22;
  return true;
}

using BlockMap = Eigen::Map<const Eigen::Matrix<double, 3, 3>, Eigen::Unaligned, Eigen::OuterStride<4>>;

BlockMap as_matrix(const std::array<double, 12>& block) { return BlockMap(block.data()); }

void store(const Mat3& m, std::array<double, 12>& block) {
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) block[4 * c + r] = m(r, c);
    block[4 * c + 3] = 0;
  }
}

std::vector<int> minimum_degree_order(int num_rows, const std::vector<std::array<int, 2>>& pairs) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < num_rows; ++i) entries.emplace_back(i, i, 1.0);
  for (const auto& [i, j] : pairs) {
    entries.emplace_back(i, j, 1.0);
    entries.emplace_back(j, i, 1.0);
  }
  Eigen::SparseMatrix<double> pattern(num_rows, num_rows);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(pattern, permutation);
  return {permutation.indices().begin(), permutation.indices().end()};
}

}  // namespace

void multiply(const SymmetricBlockMatrix& a, const std::vector<Vec3>& x, std::vector<Vec3>& y) {
  y.resize(x.size());
  for (int i = 0; i < a.num_rows(); ++i) y[i] = a.diagonal[i] * x[i];
  for (std::size_t p = 0; p < a.pairs.size(); ++p) {
    const auto& [i, j] = a.pairs[p];
    y[i] += a.off_diagonal[p] * x[j];
    y[j] += a.off_diagonal[p].transpose() * x[i];
  }
}

void BlockCholesky::analyze(int num_rows, const std::vector<std::array<int, 2>>& pairs) {
  num_rows_ = num_rows;
  order_ = minimum_degree_order(num_rows, pairs);
  std::vector<int> place(num_rows);
  for (int k = 0; k < num_rows; ++k) place[order_[k]] = k;

  upper_.assign(num_rows, {});
  for (int p = 0; p < static_cast<int>(pairs.size()); ++p) {
    const int i = place[pairs[p][0]], j = place[pairs[p][1]];
    upper_[std::max(i, j)].push_back({std::min(i, j), p, i > j});
  }

  // Elimination tree, and the number of blocks in each column of L.
  parent_.assign(num_rows, -1);
  std::vector<std::size_t> count(num_rows, 0);
  mark_.assign(num_rows, -1);
  for (int k = 0; k < num_rows; ++k) {
    mark_[k] = k;
    for (const Entry& entry : upper_[k]) {
      for (int i = entry.row; mark_[i] != k; i = parent_[i]) {
        if (parent_[i] < 0) parent_[i] = k;
        ++count[i];
        mark_[i] = k;
      }
    }
  }
  column_begin_.assign(num_rows + 1, 0);
  for (int k = 0; k < num_rows; ++k) column_begin_[k + 1] = column_begin_[k] + count[k];
  row_.resize(column_begin_.back());
  block_.resize(column_begin_.back());
  inverse_diagonal_.resize(num_rows);
  column_.assign(num_rows, Block{});
  stack_.resize(num_rows);
  path_.resize(num_rows);
  filled_.resize(num_rows);
}

/// Spreads column k of A, above the diagonal, over column_.
void BlockCholesky::load_column(const SymmetricBlockMatrix& a, int k) {
  for (const Entry& entry : upper_[k]) {
    const Mat3& source = a.off_diagonal[entry.pair];
    Block& target = column_[entry.row];
    for (int c = 0; c < 3; ++c) {
      for (int r = 0; r < 3; ++r) target[4 * c + r] += entry.transposed ? source(c, r) : source(r, c);
    }
  }
}

bool BlockCholesky::factorize(const SymmetricBlockMatrix& a) {
  std::copy(column_begin_.begin(), column_begin_.end() - 1, filled_.begin());
  std::fill(mark_.begin(), mark_.end(), -1);
  std::fill(column_.begin(), column_.end(), Block{});
  for (int k = 0; k < num_rows_; ++k) {
    load_column(a, k);

    // The nonzero rows of column k of Lᵀ, in an order in which they can be computed.
    int top = num_rows_;
    mark_[k] = k;
    for (const Entry& entry : upper_[k]) {
      int length = 0;
      for (int i = entry.row; mark_[i] != k; i = parent_[i]) {
        path_[length++] = i;
        mark_[i] = k;
      }
      while (length > 0) stack_[--top] = path_[--length];
    }

    Mat3 diagonal = a.diagonal[order_[k]];
    for (; top < num_rows_; ++top) {
      const int i = stack_[top];
      const Mat3 x = inverse_diagonal_[i] * as_matrix(column_[i]);
      column_[i] = Block{};
      Block x_padded;
      store(x, x_padded);
      const std::size_t begin = column_begin_[i], end = filled_[i]++;
      subtract_column(block_[begin].data(), &row_[begin], end - begin, x_padded.data(), column_[0].data());
      diagonal -= x.transpose() * x;
      store(x.transpose(), block_[end]);
      row_[end] = k;
    }
    if (!invert_cholesky_factor(diagonal, inverse_diagonal_[k])) return false;
  }
  return true;
}

void BlockCholesky::solve(std::vector<Vec3>& b) const {
  std::vector<Vec3> x(num_rows_);
  for (int k = 0; k < num_rows_; ++k) x[k] = b[order_[k]];
  for (int k = 0; k < num_rows_; ++k) {
    x[k] = inverse_diagonal_[k] * x[k];
    for (std::size_t p = column_begin_[k]; p < column_begin_[k + 1]; ++p)
      x[row_[p]] -= as_matrix(block_[p]) * x[k];
  }
  for (int k = num_rows_ - 1; k >= 0; --k) {
    for (std::size_t p = column_begin_[k]; p < column_begin_[k + 1]; ++p) {
      x[k] -= as_matrix(block_[p]).transpose() * x[row_[p]];
    }
    x[k] = inverse_diagonal_[k].transpose() * x[k];
  }
  for (int k = 0; k < num_rows_; ++k) b[order_[k]] = x[k];
}

}  // namespace weft::engine
