/// The multigrid preconditioners as standalone solvers, and conjugate gradients with them.

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cmath>
#include <functional>

#include "weft/core/random.h"
#include "weft/core/simd.h"
#include "weft/solvers/aggregation_multigrid.h"
#include "weft/solvers/conjugate_gradients.h"
#include "weft/solvers/grid_multigrid.h"

namespace weft::engine {
namespace {

/// A scalar matrix, the same in double precision, and the application of its multigrid.
struct Problem {
  int size = 0;
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<int> index;  // of each row in the fields
  std::size_t field_size = 0;
  std::function<double(const Vec3Array&, Vec3Array&)> cycle;
  std::shared_ptr<JobSystem> jobs = make_serial_jobs();

  Eigen::SparseMatrix<double> matrix() const {
    Eigen::SparseMatrix<double> a(size, size);
    a.setFromTriplets(entries.begin(), entries.end());
    return a;
  }

  void couple(int i, int j, double c) {
    entries.emplace_back(i, i, c);
    entries.emplace_back(j, j, c);
    entries.emplace_back(i, j, -c);
    entries.emplace_back(j, i, -c);
  }
};

constexpr double kStiffness = 2000, kShear = 1000;

/// A sheet of columns × rows with springs along rows, columns and one diagonal (or both), inertia as of
/// 0.2 kg/m² at 60 steps per second, two corners pinned.
Problem grid_problem(int columns, int rows, bool both_diagonals) {
  Problem p;
  p.size = columns * rows;
  auto multigrid = std::make_shared<GridMultigrid>();
  const PaddedRows layout{columns, rows};
  multigrid->resize(layout);
  GridLevel& level = multigrid->finest();
  level.has_down_left = both_diagonals;
  p.field_size = layout.size();
  const double inertia = 2.25 * 3600 * 0.2 / p.size;
  const auto is_pinned = [&](int i) { return i == 0 || i == columns - 1; };
  const auto join = [&](int i, int j, double c, AlignedFloats& couplings) {
    if (is_pinned(i) || is_pinned(j)) {
      const int other = is_pinned(i) ? j : i;
      if (is_pinned(other)) return;
      level.excess[layout.index(other)] += static_cast<float>(c);
      p.entries.emplace_back(other, other, c);
    } else {
      couplings[layout.index(i)] = static_cast<float>(c);
      p.couple(i, j, c);
    }
  };
  for (int i = 0; i < p.size; ++i) {
    p.index.push_back(layout.index(i));
    const int column = i % columns, row = i / columns;
    const bool right = column + 1 < columns, down = row + 1 < rows;
    if (right) join(i, i + 1, kStiffness, level.right);
    if (down) join(i, i + columns, kStiffness, level.down);
    if (right && down) join(i, i + columns + 1, kShear, level.down_right);
    if (both_diagonals && column > 0 && down) join(i, i + columns - 1, kShear, level.down_left);
    if (!is_pinned(i)) level.excess[layout.index(i)] += static_cast<float>(inertia);
    p.entries.emplace_back(i, i, is_pinned(i) ? 1.0 : inertia);
  }
  multigrid->build(*p.jobs);
  p.cycle = [multigrid, jobs = p.jobs](const Vec3Array& r, Vec3Array& z) {
    return multigrid->apply(r, *jobs, z);
  };
  return p;
}

/// The same sheet for the mesh multigrid; alternating diagonals, no pins.
Problem mesh_problem(int side) {
  Problem p;
  p.size = side * side;
  std::vector<std::vector<std::pair<int, double>>> around(p.size);
  const auto join = [&](int i, int j) {
    around[i].push_back({j, kStiffness});
    around[j].push_back({i, kStiffness});
    p.couple(i, j, kStiffness);
  };
  const double inertia = 2.25 * 3600 * 0.2 / p.size;
  for (int i = 0; i < p.size; ++i) {
    const int column = i % side, row = i / side;
    const bool right = column + 1 < side, down = row + 1 < side;
    if (right) join(i, i + 1);
    if (down) join(i, i + side);
    if (right && down) (column + row) % 2 == 0 ? join(i, i + side + 1) : join(i + 1, i + side);
    p.entries.emplace_back(i, i, inertia);
    p.index.push_back(i);
  }
  SparseMatrix couplings;
  couplings.num_columns = p.size;
  for (const auto& row : around) {
    for (const auto& [j, c] : row) couplings.add_entry(j, c);
    couplings.end_row();
  }
  auto multigrid = std::make_shared<AggregationMultigrid>();
  multigrid->build(couplings, std::vector<double>(p.size, inertia));
  p.field_size = static_cast<std::size_t>(p.size);
  p.cycle = [multigrid, jobs = p.jobs](const Vec3Array& r, Vec3Array& z) {
    return multigrid->apply(r, 0, *jobs, z);
  };
  return p;
}

/// The field of a vector in all three components, scaled differently in each.
Vec3Array to_field(const Problem& p, const Eigen::VectorXd& v) {
  Vec3Array field(p.field_size);
  for (int i = 0; i < p.size; ++i) field.set(p.index[i], {v[i], -2 * v[i], 0.5 * v[i]});
  return field;
}

Eigen::VectorXd random_vector(int size, std::uint64_t seed) {
  Random random(seed);
  Eigen::VectorXd v(size);
  for (int i = 0; i < size; ++i) v[i] = random.uniform(-1, 1);
  return v;
}

/// Zero at pins, whose rows are those of the identity.
Eigen::VectorXd without_pins(const Problem& p, Eigen::VectorXd v) {
  const Eigen::SparseMatrix<double> a = p.matrix();
  for (int i = 0; i < p.size; ++i) {
    if (a.coeff(i, i) == 1.0) v[i] = 0;
  }
  return v;
}

/// The factor by which each cycle of u ← u + V (b − A u) reduces the error in the norm of A.
std::vector<double> reductions(const Problem& p, int cycles) {
  const Eigen::SparseMatrix<double> a = p.matrix();
  Eigen::VectorXd error = without_pins(p, random_vector(p.size, 7));
  std::vector<double> result;
  double norm = std::sqrt(error.dot(a * error));
  Vec3Array z(p.field_size);
  for (int c = 0; c < cycles; ++c) {
    p.cycle(to_field(p, a * error), z);
    for (int i = 0; i < p.size; ++i) error[i] -= z.x()[p.index[i]];
    const double now = std::sqrt(error.dot(a * error));
    result.push_back(norm / now);
    norm = now;
  }
  return result;
}

TEST(GridMultigrid, ReducesTheErrorOfRoughDataFivefoldAtOnceAndSteadilyAfterwardsOnEveryGrid) {
  for (const auto& [columns, rows] :
       {std::pair{33, 33}, {64, 64}, {65, 40}, {128, 128}, {127, 128}, {2, 100}, {7, 5}}) {
    for (const bool both : {false, true}) {
      const std::vector<double> found = reductions(grid_problem(columns, rows, both), 12);
      EXPECT_GT(found[0], 5) << columns << " x " << rows << (both ? ", both diagonals" : "");
      for (int c = 1; c < 12; ++c) EXPECT_GT(found[c], 2.3) << columns << " x " << rows << ", cycle " << c;
    }
  }
}

TEST(AggregationMultigrid, ReducesTheErrorSteadilyOnMeshesOfAnySize) {
  for (const int side : {20, 45, 90, 140}) {
    const std::vector<double> found = reductions(mesh_problem(side), 10);
    EXPECT_GT(found[0], 3) << side;
    for (int c = 5; c < 10; ++c) EXPECT_GT(found[c], 1.5) << side << ", cycle " << c;
  }
}

TEST(Multigrid, IsSymmetricAndPositiveDefinite) {
  for (const Problem& p : {grid_problem(40, 23, false), grid_problem(33, 34, true), mesh_problem(30)}) {
    const Eigen::VectorXd u = without_pins(p, random_vector(p.size, 1));
    const Eigen::VectorXd v = without_pins(p, random_vector(p.size, 2));
    Vec3Array zu(p.field_size), zv(p.field_size);
    EXPECT_GT(p.cycle(to_field(p, u), zu), 0);
    EXPECT_GT(p.cycle(to_field(p, v), zv), 0);
    double uv = 0, vu = 0, uu = 0;
    for (int i = 0; i < p.size; ++i) {
      uv += u[i] * zv.x()[p.index[i]];
      vu += v[i] * zu.x()[p.index[i]];
      uu += u[i] * zu.x()[p.index[i]];
    }
    EXPECT_NEAR(uv, vu, 1e-5 * uu) << "rounding of floats";
  }
}

TEST(Multigrid, HandlesParticlesThatNothingHolds) {
  // Three components: a pair, a single particle, and one that drops out.
  SparseMatrix couplings;
  couplings.num_columns = 4;
  couplings.add_entry(1, 1e6);
  couplings.end_row();
  couplings.add_entry(0, 1e6);
  couplings.end_row();
  couplings.end_row();
  couplings.end_row();
  AggregationMultigrid multigrid;
  multigrid.build(couplings, {1e-3, 1e-3, 5, 0});
  Vec3Array r(4), z(4);
  for (int i = 0; i < 4; ++i) r.set(i, {1, 0, 0});
  const auto jobs = make_serial_jobs();
  multigrid.apply(r, 0, *jobs, z);
  EXPECT_NEAR(z.get(0).x(), 1000, 1) << "two particles of 1e-3 N/m, pulled by 1 N each";
  EXPECT_NEAR(z.get(2).x(), 0.2, 1e-6);
  EXPECT_EQ(z.get(3).x(), 0);
}

/// The matrix of a problem, as a function for conjugate gradients.
auto make_multiply(const Problem& p, const Eigen::SparseMatrix<double>& a) {
  return [&](const Vec3Array& in, Vec3Array& out) {
    Eigen::MatrixXd v(p.size, 3);
    for (int i = 0; i < p.size; ++i) v.row(i) = in.get(p.index[i]).transpose();
    const Eigen::MatrixXd product = a * v;
    for (int i = 0; i < p.size; ++i) out.set(p.index[i], product.row(i).transpose());
    return v.cwiseProduct(product).sum();
  };
}

TEST(ConjugateGradients, ComeToTheSolutionOfSparseCholesky) {
  for (const Problem& p : {grid_problem(50, 50, false), mesh_problem(50)}) {
    const Eigen::SparseMatrix<double> a = p.matrix();
    const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> cholesky(a);
    const Eigen::VectorXd b = without_pins(p, random_vector(p.size, 3));
    const Eigen::VectorXd expected = cholesky.solve(b);
    const auto multiply = make_multiply(p, a);
    ConjugateGradients gradients;
    Vec3Array x;
    const CgReport report =
        gradients.solve(multiply, p.cycle, to_field(p, b), {.iterations = 30}, *p.jobs, x);
    double error = 0;
    for (int i = 0; i < p.size; ++i) {
      const Vec3 want = {expected[i], -2 * expected[i], 0.5 * expected[i]};
      error = std::max(error, (x.get(p.index[i]) - want).norm());
    }
    // Floats, and a condition number of some thousands.
    EXPECT_LT(error, 1e-4 * expected.cwiseAbs().maxCoeff());
    const double decrease = 0.5 * b.dot(expected) * (1 + 4 + 0.25);
    EXPECT_NEAR(report.decrease, decrease, 1e-5 * decrease);
  }
}

TEST(ConjugateGradients, StopWhereNothingIsLeftToGain) {
  const Problem p = grid_problem(50, 50, false);
  const Eigen::SparseMatrix<double> a = p.matrix();
  const Eigen::VectorXd b = without_pins(p, random_vector(p.size, 3));
  const auto multiply = make_multiply(p, a);
  ConjugateGradients gradients;
  Vec3Array x;
  const CgSettings settings{.iterations = 100, .enough = 1e-4};
  EXPECT_LT(gradients.solve(multiply, p.cycle, to_field(p, b), settings, *p.jobs, x).iterations, 15);
  const Vec3Array zero(p.field_size);
  EXPECT_EQ(gradients.solve(multiply, p.cycle, zero, settings, *p.jobs, x).iterations, 0);
}

}  // namespace
}  // namespace weft::engine
