/// The forces of `xpbd` against the list of terms in doubles: as the step goes to zero, its particles are accelerated by
/// the sum of the list's forces.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/forces/every_term.h"
#include "weft/forces/terms.h"
#include "weft/integrators/integrator.h"

namespace weft::engine {
namespace {

/// Without damping, and what `xpbd` does not support: friction of threads, memory of bending.
std::shared_ptr<const ClothModel> without_damping_and_memory(const ClothModel& model) {
  ClothMaterial material = model.material;
  material.damping = material.damping_time = 0;
  std::shared_ptr<ClothElements> elements;
  if (model.elements) {
    elements = std::make_shared<ClothElements>(*model.elements);
    elements->damping = 0;
    elements->thread_bends = {};
  }
  return with_gas(*build_cloth_model(model.topology, material, elements), model.gas);
}

TEST(XpbdTerms, HaveTheForcesOfTheListInShortSteps) {
  constexpr double kStep = 5e-6;
  const auto jobs = make_serial_jobs();
  int num_telling = 0;
  for (const auto& [name, whole, start] : test::make_crumpled_cloths()) {
    const auto model = without_damping_and_memory(*whole);
    const int n = model->num_particles();
    ClothState state = start;
    state.bending = {};
    const Terms terms = make_elastic_terms(*model, state);
    std::vector<Vec3> middle, force(n, Vec3::Zero());
    for (int i = 0; i < n; ++i) middle.push_back(state.x.get(i) + kStep * state.v.get(i));
    double weakest = std::numeric_limits<double>::infinity(), strongest = 0;
    for (const auto& term : terms) {
      std::vector<Vec3> own(n, Vec3::Zero());
      term->add_force(middle, own);
      double largest = 0;
      for (int i = 0; i < n; ++i) {
        force[i] += own[i];
        largest = std::max(largest, own[i].norm());
      }
      if (largest == 0) continue;
      weakest = std::min(weakest, largest);
      strongest = std::max(strongest, largest);
    }
    const std::vector<Vec3> before = to_doubles(state.v);
    make_xpbd({})->advance(*model, {.gravity = Vec3::Zero()}, kStep, *jobs, state);
    double error = 0;
    for (int i = 0; i < n; ++i) {
      const Vec3 by_xpbd = model->mass[i] / kStep * (state.v.get(i) - before[i]);
      error = std::max(error, (by_xpbd - force[i]).norm());
    }
    EXPECT_LT(error, 0.02 * weakest + 1e-3 * strongest) << name;
    if (1e-3 * strongest < 0.5 * weakest) ++num_telling;  // no force can be missing
  }
  EXPECT_GE(num_telling, 8);
}

}  // namespace
}  // namespace weft::engine
