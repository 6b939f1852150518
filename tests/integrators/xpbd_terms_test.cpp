/// The forces of `xpbd` against the list of terms in doubles. As the step goes to zero, its particles are accelerated
/// by the sum of the list's forces.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "tests/forces/every_term.h"
#include "weft/forces/pressure.h"
#include "weft/forces/terms.h"
#include "weft/integrators/integrator.h"
#include "weft/mesh/solid.h"

namespace weft::engine {
namespace {

using test::largest;

/// Without damping, and without memory of bending, which `xpbd` does not support.
std::shared_ptr<const ClothModel> for_xpbd(const ClothModel& model) {
  const auto undamped = test::without_damping(model);
  if (!undamped->elements) return undamped;
  auto elements = std::make_shared<ClothElements>(*undamped->elements);
  elements->thread_bends = {};
  return with_gas(*build_cloth_model(undamped->topology, undamped->material, elements), undamped->gas);
}

TEST(XpbdTerms, HaveTheForcesOfTheListInShortSteps) {
  constexpr double kStep = 5e-6;
  const auto jobs = make_serial_jobs();
  std::set<std::string> tested;  // rows that cannot be missing
  for (const auto& [name, whole, start] : test::make_crumpled_cloths()) {
    const auto model = for_xpbd(*whole);
    const int n = model->num_particles();
    ClothState state = start;
    state.bending = {};
    std::vector<Vec3> moved, error(n, Vec3::Zero());
    for (int i = 0; i < n; ++i) moved.push_back(state.x.get(i) + kStep * state.v.get(i));
    std::vector<std::pair<std::string, double>> largest_of;
    double weakest = std::numeric_limits<double>::infinity(), strongest = 0;
    for (const ElasticRow& row : elastic_rows()) {
      const std::unique_ptr<Term> term = row.make(*model, state);
      if (!term) continue;
      std::vector<Vec3> own(n, Vec3::Zero());
      term->add_force(moved, own);
      for (int i = 0; i < n; ++i) error[i] -= own[i];
      const double most = largest(own);
      if (most == 0) continue;
      largest_of.emplace_back(row.name, most);
      weakest = std::min(weakest, most);
      strongest = std::max(strongest, most);
    }
    const std::vector<Vec3> before = to_doubles(state.v);
    make_xpbd({})->advance(*model, {.gravity = Vec3::Zero()}, kStep, *jobs, state);
    for (int i = 0; i < n; ++i) error[i] += model->mass[i] / kStep * (state.v.get(i) - before[i]);
    const double tolerance = 0.02 * weakest + 1e-3 * strongest;
    EXPECT_LT(largest(error), tolerance) << name;
    for (const auto& [row, most] : largest_of) {
      if (most > 2 * tolerance) tested.insert(row);
    }
  }
  for (const ElasticRow& row : elastic_rows())
    EXPECT_EQ(tested.contains(row.name), std::string(row.name) != "friction of threads") << row.name;
}

/// A ball squeezed flat, and a little inside out: its gas makes it round.
TEST(XpbdTerms, SealedGasFillsClothThatIsInsideOut) {
  const TriangleMesh ball = make_sphere_mesh(Vec3::Zero(), 0.2, 10);
  const Fabric fabric{.density = 0.1, .c11 = 500, .c22 = 500, .c12 = 0, .g = 200};
  const auto elements =
      build_mesh_elements(ball, warp_from_direction(ball, Vec3::UnitX()), fabric, BendingModel::stencils);
  const auto whole = build_cloth_model(build_mesh_topology(ball),
                                       {.density = 0.1, .structural = 0, .shear = 0, .bend = 0}, elements);
  const auto volume_of = [&](const auto& at) { return compute_signed_volume(ball.triangles, at); };
  const double rest = volume_of([&](int v) { return ball.positions[v]; });
  const auto model = with_gas(*whole, seal_gas(0, rest));
  std::vector<Vec3> flat = ball.positions;
  for (Vec3& p : flat) p.y() *= -0.01;
  ClothState state = make_state(flat);
  const auto jobs = make_serial_jobs();
  const auto xpbd = make_xpbd({});
  for (int s = 0; s < 3000; ++s) xpbd->advance(*model, {.gravity = Vec3::Zero()}, 1.0 / 3000, *jobs, state);
  EXPECT_NEAR(volume_of([&](int v) -> Vec3 { return state.x.get(v); }) / rest, 1, 0.1);
}

}  // namespace
}  // namespace weft::engine
