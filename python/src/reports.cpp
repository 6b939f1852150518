/// Results of steps as Python classes.

#include "casts.h"

namespace weft::python {
namespace {

/// A getter of an index; None below zero.
template <class T>
auto index_or_none(int T::*field) {
  return
      [field](const T& value) { return value.*field < 0 ? std::nullopt : std::optional<int>(value.*field); };
}

void bind_work(nb::module_& m) {
  nb::class_<WorkTimes> work(m, "WorkTimes");
  work.attr("__doc__") = "Wall time of a step by kind of work; the kinds do not overlap.";
  const auto time = [&](const char* name, double WorkTimes::*field, const char* doc) {
    work.def_ro(name, field, doc);
  };
  time("total", &WorkTimes::total, "Of whole steps [s]");
  time("lists", &WorkTimes::lists, "Broad phase: candidate pair lists [s]");
  time("narrow_phase", &WorkTimes::narrow_phase, "Distances of listed pairs and of primitive shapes [s]");
  time("rows", &WorkTimes::rows, "Contacts in the solve: their linearisation and energy [s]");
  time("set_up", &WorkTimes::set_up, "Preconditioners rebuilt for contacts [s]");
  time("product", &WorkTimes::product, "Products of the contact Hessian with a vector [s]");
  time("v_cycle", &WorkTimes::v_cycle, "Preconditioners applied [s]");
  time("projection", &WorkTimes::projection, "Gauss–Seidel on positions and velocities [s]");
  time("ccd", &WorkTimes::ccd, "Continuous collision detection [s]");
  time("retries", &WorkTimes::retries, "All work of discarded parts of steps: not a separate kind [s]");
  work.def_ro("pairs_listed", &WorkTimes::pairs_listed, "In the longest list")
      .def_ro("pairs_tested", &WorkTimes::pairs_tested, "In all passes over the list together")
      .def_ro("active", &WorkTimes::active, "Contacts with a force");
}

}  // namespace

void bind_reports(nb::module_& m) {
  bind_work(m);
  nb::class_<StepWarning> warning(m, "StepWarning");
  warning.attr("__doc__") =
      "A problem of a step. `World.describe` gives the sentence, with the key to change.";
  warning
      .def_prop_ro(
          "code", [](const StepWarning& w) { return name_of(w.code); }, "Its kind, as \"yarn_strain\"")
      .def_prop_ro("cloth", index_or_none(&StepWarning::cloth),
                   "Index in `World.cloths`; None: no specific one")
      .def_prop_ro("particle", index_or_none(&StepWarning::particle), "Its index; None: no specific one")
      .def_ro("value", &StepWarning::value, "See the code: a strain, a share, an energy [J], a number")
      .def_prop_ro(
          "fault", [](const StepWarning& w) { return name_of(w.fault); }, "The reason, of \"cap_reached\"")
      .def_prop_ro("collider", index_or_none(&StepWarning::collider),
                   "Index in `World.colliders`, of \"penetration\"; else None")
      .def("__repr__", [](const StepWarning& w) {
        return "StepWarning(code=\"" + std::string(name_of(w.code)) + "\", cloth=" + std::to_string(w.cloth) +
               ", particle=" + std::to_string(w.particle) + ", value=" + std::to_string(w.value) + ")";
      });

  nb::class_<InfeasiblePair> pair(m, "InfeasiblePair");
  pair.attr("__doc__") = "A pair of features that prescribed motions leave no room for.";
  pair.def_prop_ro("cloth", index_or_none(&InfeasiblePair::cloth), "Index in `World.cloths`")
      .def_prop_ro("particle", index_or_none(&InfeasiblePair::particle), "Of `cloth`")
      .def_prop_ro("other_cloth", index_or_none(&InfeasiblePair::other_cloth),
                   "Index in `World.cloths`; None: a collider")
      .def_prop_ro("other_particle", index_or_none(&InfeasiblePair::other_particle), "Of `other_cloth`")
      .def_prop_ro("collider", index_or_none(&InfeasiblePair::collider),
                   "Index in `World.colliders`; None: cloth")
      .def_prop_ro(
          "kind", [](const InfeasiblePair& p) { return name_of(p.kind); },
          "\"passed\": pushed through each other; \"caught\": between colliders that overlap");

  nb::class_<StepReport> report(m, "StepReport");
  report.attr("__doc__") = "Result of a step.";
  report
      .def_ro("ok", &StepReport::ok, "False: the step failed, and every cloth has its state before the step.")
      .def_ro("warnings", &StepReport::warnings, nb::rv_policy::copy,
              "Problems of a step that was made: the result is below the requested accuracy.")
      .def_ro("substeps", &StepReport::substeps, "Of the cloth with the most")
      .def_ro("divisions", &StepReport::divisions, "Parts of the divided step")
      .def_ro("retries", &StepReport::retries, "Parts that were too long, and were repeated")
      .def_prop_ro(
          "fault",
          [](const StepReport& r) -> std::optional<std::string_view> {
            return r.fault ? std::optional(name_of(*r.fault)) : std::nullopt;
          },
          "Of the worst repeated part: \"stretch\", \"collapse\", \"energy\", …; None: none")
      .def_ro("iterations", &StepReport::iterations, "Of nonlinear solvers, over all cloths")
      .def_ro("linear_iterations", &StepReport::linear_iterations,
              "Of linear solvers inside them; None without any")
      .def_ro(
          "residual", &StepReport::residual,
          "Of newton's linear solves, before the last iteration of each: the largest √(rᵀP⁻¹r) as a share of "
          "that at its start; None for other integrators")
      .def_ro("guard_events", &StepReport::guard_events, "Of newton's guard; None for other integrators")
      .def_ro("hits", &StepReport::hits, "Pairs that reached continuous collision detection")
      .def_ro("zones", &StepReport::zones, "Its rigid impact zones")
      .def_ro("torn", &StepReport::torn,
              "Cuts through vertices where cloth tore: its particles and triangles have changed")
      .def_ro("infeasible", &StepReport::infeasible, nb::rv_policy::copy,
              "Pairs pushed through each other by prescribed motions")
      .def_ro("work", &StepReport::work, "Wall time by kind of work")
      .def_prop_ro(
          "_is_clean", [](const StepReport& r) { return r.ok && r.warnings.empty(); }, "No problem at all")
      .def("__repr__", [](const StepReport& r) {
        std::string text = std::string("StepReport(ok=") + (r.ok ? "True" : "False") +
                           ", divisions=" + std::to_string(r.divisions) +
                           ", iterations=" + std::to_string(r.iterations) + ", warnings=[";
        for (const StepWarning& w : r.warnings)
          text += (text.back() == '[' ? "\"" : ", \"") + std::string(name_of(w.code)) + "\"";
        return text + "])";
      });
}

}  // namespace weft::python
