#include "weft/forces/terms.h"

#include <utility>

#include "weft/forces/collapse.h"
#include "weft/forces/element_terms.h"
#include "weft/forces/environment_terms.h"
#include "weft/forces/pressure.h"
#include "weft/forces/seam_springs.h"
#include "weft/forces/spring_terms.h"
#include "weft/forces/thread_bends.h"

namespace weft::engine {
namespace {

constexpr ElasticRow kElastic[] = {
    {"springs", ElasticPart::stretch, InNewton::by_kernel, make_stretch_spring_term},
    {"bend springs", ElasticPart::bending, InNewton::by_kernel, make_bend_spring_term},
    {"membranes", ElasticPart::stretch, InNewton::by_kernel, make_membrane_term},
    {"curvature stencils", ElasticPart::bending, InNewton::by_kernel, make_stencil_term},
    {"hinges", ElasticPart::bending, InNewton::by_kernel, make_hinge_term},
    {"collapse", ElasticPart::stretch, InNewton::by_kernel, make_collapse_term},
    {"friction of threads", ElasticPart::bending, InNewton::by_kernel, make_thread_bend_term},
    {"seams", ElasticPart::stretch, InNewton::as_written, make_seam_term},
    {"gas", ElasticPart::stretch, InNewton::by_kernel, make_gas_term},
};

void add(std::unique_ptr<Term> term, Terms& terms) {
  if (term) terms.push_back(std::move(term));
}

}  // namespace

std::span<const ElasticRow> elastic_rows() { return kElastic; }

Terms make_elastic_terms(const ClothModel& model, const ClothState& state) {
  Terms terms;
  for (const ElasticRow& row : kElastic) add(row.make(model, state), terms);
  return terms;
}

Terms make_terms_as_written(const ClothModel& model, const ClothState& state) {
  Terms terms;
  for (const ElasticRow& row : kElastic) {
    if (row.in_newton == InNewton::as_written) add(row.make(model, state), terms);
  }
  return terms;
}

Terms make_damping_terms(const ClothModel& model, const Motion& motion) {
  Terms terms;
  add(make_spring_damping_term(model, motion), terms);
  add(make_element_damping_term(model, motion), terms);
  return terms;
}

Terms make_air_terms(const ClothModel& model, const ClothState& state, const Wind& wind, double time,
                     const Motion& motion) {
  Terms terms;
  add(make_wind_term(model, wind, motion), terms);
  add(make_air_term(find_air(model, state, wind, time), motion), terms);
  return terms;
}

void advance_memory(const ClothModel& model, double step, ClothState& state) {
  advance_thread_bends(model, state);
  advance_seams(model, step, state);
}

double sum_energies(const Terms& terms, const Term::Positions& x) {
  double energy = 0;
  for (const auto& term : terms) energy += term->energy(x);
  return energy;
}

void add_forces(const Terms& terms, const Term::Positions& x, std::vector<Vec3>& force) {
  for (const auto& term : terms) term->add_force(x, force);
}

}  // namespace weft::engine
