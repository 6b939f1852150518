/// The preconditioner is symmetric and positive definite for any contacts.

#include "weft/integrators/contact_preconditioner.h"

#include <gtest/gtest.h>

#include "tests/support.h"
#include "weft/forces/potential.h"

namespace weft::engine {
namespace {

double dot(const Vec3Array& a, const Vec3Array& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a.get(i).dot(b.get(i));
  return sum;
}

/// Divides by d, as a matrix without couplings would.
auto by_diagonal(double d) {
  return [d](const Vec3Array& r, JobSystem&, Vec3Array& z) {
    for (std::size_t i = 0; i < r.size(); ++i) z.set(i, r.get(i) / d);
    return dot(r, z);
  };
}

struct ContactPreconditionerTest : testing::Test {
  static constexpr double kStiff = 1000, kFree = 2;
  const PaddedRows rows = padded_rows_of(*build_grid_topology(test::square(3, 1), SpringModel::simplified));
  ContactPreconditioner preconditioner;
  std::unique_ptr<JobSystem> jobs = make_serial_jobs();

  Vec3Array apply(const Vec3Array& r) {
    Vec3Array z(rows.size());
    const double told = preconditioner.apply(by_diagonal(kStiff), by_diagonal(kFree), r, *jobs, z);
    EXPECT_NEAR(told, dot(r, z), 1e-5 * std::abs(told) + 1e-12);
    return z;
  }

  Vec3Array pushed_at(int particle, const Vec3& force) const {
    Vec3Array r(rows.size());
    r.set(rows.index(particle), force);
    return r;
  }
};

TEST_F(ContactPreconditionerTest, WithoutContactsIsTheFreeOneAlone) {
  const Vec3Array z = apply(pushed_at(5, {1, 2, 3}));
  EXPECT_NEAR(z.get(rows.index(5)).z(), 3 / kFree, 1e-6);
}

TEST_F(ContactPreconditionerTest, IsStiffAlongTheNormalAndFreeAcrossIt) {
  preconditioner.add_normal(rows.index(5), Vec3::UnitY(), rows.size());
  const Vec3 z = apply(pushed_at(5, {1, 1, 1})).get(rows.index(5));
  EXPECT_NEAR(z.y(), 1 / kStiff, 1e-6);
  EXPECT_NEAR(z.x(), 1 / kStiff + 1 / kFree, 1e-6);
}

TEST_F(ContactPreconditionerTest, ThreeNormalsLeaveNothingFree) {
  preconditioner.add_normal(rows.index(5), Vec3(1, 1, 0).normalized(), rows.size());
  preconditioner.add_normal(rows.index(5), Vec3(1, 1, 0.1).normalized(),
                            rows.size());  // almost the same: not a new one
  preconditioner.add_normal(rows.index(5), Vec3(0, 1, 1).normalized(), rows.size());
  preconditioner.add_normal(rows.index(5), Vec3::UnitX(), rows.size());
  const Vec3 z = apply(pushed_at(5, {1, -2, 3})).get(rows.index(5));
  EXPECT_LT((z - Vec3(1, -2, 3) / kStiff).norm(), 1e-5);
}

TEST_F(ContactPreconditionerTest, IsSymmetricAndPositive) {
  preconditioner.add_normal(rows.index(5), Vec3(1, 2, 3).normalized(), rows.size());
  preconditioner.add_normal(rows.index(6), Vec3(-1, 2, 0).normalized(), rows.size());
  preconditioner.add_normal(rows.index(6), Vec3(0, 2, -1).normalized(), rows.size());
  for (const int i : {5, 6}) {
    for (const int j : {5, 6, 7}) {
      const Vec3Array a = pushed_at(i, {0.3, -0.7, 0.2}), b = pushed_at(j, {-0.1, 0.4, 0.9});
      EXPECT_NEAR(dot(a, apply(b)), dot(b, apply(a)), 1e-6);
      EXPECT_GT(dot(a, apply(a)), 0);
    }
  }
}

TEST_F(ContactPreconditionerTest, GivesTheSameBitsForAnyNumberOfThreads) {
  preconditioner.add_normal(rows.index(5), Vec3(1, 2, 3).normalized(), rows.size());
  const Vec3Array r = pushed_at(5, {1, -2, 3});
  const Vec3Array alone = apply(r);
  for (const int threads : {2, 5}) {
    jobs = make_jobs(threads);
    const Vec3Array z = apply(r);
    for (std::size_t i = 0; i < z.size(); ++i) EXPECT_EQ(z.get(i), alone.get(i)) << threads << ", " << i;
  }
}

TEST_F(ContactPreconditionerTest, ForgetsContacts) {
  preconditioner.add_normal(rows.index(5), Vec3::UnitY(), rows.size());
  preconditioner.clear();
  EXPECT_NEAR(apply(pushed_at(5, {0, 1, 0})).get(rows.index(5)).y(), 1 / kFree, 1e-6);
}

}  // namespace
}  // namespace weft::engine
