#include "weft/solvers/block_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "tests/support.h"

namespace weft::engine {
namespace {

Mat3 random_matrix(Random& random) {
  Mat3 m;
  for (int e = 0; e < 9; ++e) m(e % 3, e / 3) = random.uniform(-1, 1);
  return m;
}

/// Random pairs (some of them twice, in both directions), diagonally dominant.
SymmetricBlockMatrix random_spd(int n, Random& random) {
  SymmetricBlockMatrix a;
  a.diagonal.assign(n, Mat3::Zero());
  for (int p = 0; p < 3 * n; ++p) {
    const int i = static_cast<int>(random.uniform(0, n)), j = static_cast<int>(random.uniform(0, n));
    if (i == j) continue;
    a.pairs.push_back({i, j});
    a.off_diagonal.push_back(random_matrix(random));
    for (const int k : {i, j}) a.diagonal[k] += 5 * Mat3::Identity();
  }
  for (Mat3& d : a.diagonal) d += Mat3::Identity();
  return a;
}

Eigen::MatrixXd to_dense(const SymmetricBlockMatrix& a) {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * a.num_rows(), 3 * a.num_rows());
  for (int i = 0; i < a.num_rows(); ++i) dense.block<3, 3>(3 * i, 3 * i) = a.diagonal[i];
  for (std::size_t p = 0; p < a.pairs.size(); ++p) {
    const auto& [i, j] = a.pairs[p];
    dense.block<3, 3>(3 * i, 3 * j) += a.off_diagonal[p];
    dense.block<3, 3>(3 * j, 3 * i) += a.off_diagonal[p].transpose();
  }
  return dense;
}

TEST(BlockCholesky, SolvesAsADenseFactorisationDoes) {
  Random random(5);
  for (const int n : {1, 2, 3, 10, 60}) {
    const SymmetricBlockMatrix a = random_spd(n, random);
    BlockCholesky cholesky;
    cholesky.analyze(n, a.pairs);
    ASSERT_TRUE(cholesky.factorize(a));
    std::vector<Vec3> b(n);
    for (Vec3& v : b) v = test::random_vector(random, 1);
    const Eigen::VectorXd expected = to_dense(a).llt().solve(Eigen::Map<Eigen::VectorXd>(b[0].data(), 3 * n));
    cholesky.solve(b);
    EXPECT_LT((Eigen::Map<Eigen::VectorXd>(b[0].data(), 3 * n) - expected).norm(),
              1e-12 * (1 + expected.norm()));
  }
}

TEST(BlockCholesky, FactorisesNewValuesOfTheSamePattern) {
  Random random(6);
  SymmetricBlockMatrix a = random_spd(20, random);
  BlockCholesky cholesky;
  cholesky.analyze(20, a.pairs);
  ASSERT_TRUE(cholesky.factorize(a));
  for (Mat3& d : a.diagonal) d *= 2;
  ASSERT_TRUE(cholesky.factorize(a));
  std::vector<Vec3> x(20, Vec3(1, 2, 3)), b;
  multiply(a, x, b);
  cholesky.solve(b);
  for (const Vec3& v : b) EXPECT_LT((v - Vec3(1, 2, 3)).norm(), 1e-12);
}

TEST(BlockCholesky, SaysWhenAMatrixIsNotPositiveDefinite) {
  Random random(8);
  SymmetricBlockMatrix a = random_spd(20, random);
  BlockCholesky cholesky;
  cholesky.analyze(20, a.pairs);
  a.diagonal[7] = -a.diagonal[7];
  EXPECT_FALSE(cholesky.factorize(a));
  a.diagonal[7].setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(cholesky.factorize(a));
}

}  // namespace
}  // namespace weft::engine
