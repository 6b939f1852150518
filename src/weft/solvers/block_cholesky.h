#pragma once
/// Sparse Cholesky factorisation of symmetric matrices made of 3×3 blocks, one block row per particle.
///
/// The reference solver: exact to rounding and bit-identical on every machine, but its cost grows faster than
/// the number of particles. The order of elimination is Eigen's approximate minimum degree; the factorisation
/// is up-looking (T. Davis, Direct Methods for Sparse Linear Systems, 2006, chapter 4) on blocks.

#include <array>
#include <vector>

#include "weft/core/vec.h"

namespace weft::engine {

/// A = diagonal blocks + for each pair (i, j) the block at (i, j) and its transpose at (j, i). Pairs may
/// repeat: their blocks add up.
struct SymmetricBlockMatrix {
  std::vector<std::array<int, 2>> pairs;  // i != j
  std::vector<Mat3> diagonal;             // (n)
  std::vector<Mat3> off_diagonal;         // (pairs)

  int num_rows() const { return static_cast<int>(diagonal.size()); }
};

/// y = A x.
void multiply(const SymmetricBlockMatrix& a, const std::vector<Vec3>& x, std::vector<Vec3>& y);

class BlockCholesky {
 public:
  /// Symbolic analysis for all matrices with these pairs. Only the pattern matters, not the values.
  void analyze(int num_rows, const std::vector<std::array<int, 2>>& pairs);

  /// Factorises a matrix of the analysed pattern. Returns false if it is not positive definite (or not
  /// finite): then do not call solve().
  [[nodiscard]] bool factorize(const SymmetricBlockMatrix& a);

  /// Replaces b by A⁻¹ b.
  void solve(std::vector<Vec3>& b) const;

  /// Number of blocks in the factor below its diagonal [1].
  std::size_t num_factor_blocks() const { return row_.size(); }

 private:
  /// Column-major 3×3 block, each column padded to four numbers so that it fills a SIMD register.
  using Block = std::array<double, 12>;

  struct Entry {
    int row;          // row < column, in elimination order
    int pair;         // index into the matrix's pairs
    bool transposed;  // whether the pair's block lies below the diagonal in elimination order
  };

  void load_column(const SymmetricBlockMatrix& a, int k);

  int num_rows_ = 0;
  std::vector<int> order_;                 // row of A eliminated k-th
  std::vector<std::vector<Entry>> upper_;  // entries of each column above the diagonal
  std::vector<int> parent_;                // elimination tree
  std::vector<std::size_t> column_begin_;  // (n + 1) first block of each column of L
  std::vector<int> row_;                   // row of each block of L
  std::vector<Block> block_;               // blocks of L below the diagonal
  std::vector<Mat3> inverse_diagonal_;     // inverses of L's diagonal blocks, lower triangular

  // Work space of factorize().
  std::vector<Block> column_;
  std::vector<int> mark_, stack_, path_;
  std::vector<std::size_t> filled_;
};

}  // namespace weft::engine
