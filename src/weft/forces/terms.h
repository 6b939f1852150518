#pragma once
/// The list of the terms of a cloth's potential. A new force is a file with its Term, and a row of this list.

#include <memory>
#include <span>
#include <vector>

#include "weft/forces/motion.h"
#include "weft/forces/term.h"
#include "weft/forces/wind.h"
#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

using Terms = std::vector<std::unique_ptr<Term>>;

/// How reports count an elastic energy.
enum class ElasticPart { stretch, bending };

/// How `newton` evaluates a term.
enum class InNewton {
  by_kernel,   // by a kernel in floats (forces/potential.h, integrators/newton_term.h)
  as_written,  // by its Term, in doubles, one element after the other
};

struct ElasticRow {
  const char* name;
  ElasticPart part;
  InNewton in_newton;
  /// For a step from the state; null if the cloth has no such force. The model outlives the term.
  std::unique_ptr<Term> (*make)(const ClothModel& model, const ClothState& state);
};

/// Every elastic force.
std::span<const ElasticRow> elastic_rows();

/// The terms of all rows that the cloth has.
Terms make_elastic_terms(const ClothModel& model, const ClothState& state);

/// Of those rows only that `newton` evaluates as written.
Terms make_terms_as_written(const ClothModel& model, const ClothState& state);

/// Spring and element damping.
Terms make_damping_terms(const ClothModel& model, const Motion& motion);

/// Wind, drag and lift in a step from the state that ends at a time [s].
Terms make_air_terms(const ClothModel& model, const ClothState& state, const Wind& wind, double time,
                     const Motion& motion);

/// Moves what the state remembers of its forces: before every step [s].
void advance_memory(const ClothModel& model, double step, ClothState& state);

double sum_energies(const Terms& terms, const Term::Positions& x);  // [J]
void add_forces(const Terms& terms, const Term::Positions& x, std::vector<Vec3>& force);

}  // namespace weft::engine
