#include "weft/run/warnings.h"

#include <cstdio>

#include "weft/integrators/integrator.h"

namespace weft::engine {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string describe_cap(const StepWarning& w) {
  switch (w.fault) {
    case StepFault::stretch:
      return "a spring stretched by " + number(100 * w.value) + " % in the shortest step";
    case StepFault::collapse:
      return "a triangle shrank to " + number(100 * w.value) + " % of its area in the shortest step";
    case StepFault::energy:
      return "energy rose by " + number(w.value) + " J without work in the shortest step";
    case StepFault::infeasible:
      return "prescribed motions are infeasible in the shortest step";
    case StepFault::skipped:
    case StepFault::non_finite:
      break;
  }
  return "the cloth moved by more than its own size in the shortest step";
}

/// `collider "ball"`; "a collider" if it has been removed since.
std::string name_of_collider(const World& world, int collider) {
  const auto count = static_cast<int>(world.colliders().size());
  return collider < 0 || collider >= count ? "a collider"
                                           : "collider \"" + world.colliders()[collider].name + '"';
}

std::string describe_what(const World& world, const StepWarning& w, const std::string& advice) {
  switch (w.code) {
    case WarningCode::not_converged:
      return "the solver reached its iteration limit before its tolerance; raise solver.iterations or "
             "solver.steps_per_frame";
    case WarningCode::contact_skipped:
      return "the cloth moved by more than its own size within a step, and contact was skipped; " + advice;
    case WarningCode::non_finite:
      return "the motion of particle " + std::to_string(w.particle) + " became non-finite; " + advice;
    case WarningCode::cap_reached:
      return describe_cap(w) + "; " + advice;
    case WarningCode::yarn_strain:
      return "yarns stay stretched by " + number(100 * w.value) + " % at particle " +
             std::to_string(w.particle) + "; " + advice;
    case WarningCode::flat_triangle:
      return "a triangle at particle " + std::to_string(w.particle) + " has " + number(100 * w.value) +
             " % of its rest area; " + advice;
    case WarningCode::energy_rise:
      return "energy rose by " + number(w.value) + " J without work; " + advice;
    case WarningCode::crossings:
      return number(w.value) +
             " pairs of triangles intersect; solver.untangle = true repairs intersections at the start; "
             "for all others " +
             advice;
    case WarningCode::open_seam:
      return "a seam stays open by " + number(1000 * w.value) + " mm at particle " +
             std::to_string(w.particle) +
             "; raise seam_time or seam_stiffness, or move the panels nearer to each other";
    case WarningCode::penetration:
      return number(1000 * w.value) + " mm inside " + name_of_collider(world, w.collider) + " at particle " +
             std::to_string(w.particle) + "; " +
             (world.has_contact() ? "move bodies that overlap apart, or " + advice
                                  : "set solver.contact = true");
    case WarningCode::passages:
      return number(w.value) + " pairs of features passed through each other; " + advice;
    case WarningCode::infeasible:
      break;
  }
  return "prescribed motions are infeasible for " + number(w.value) +
         " pairs; move pins and colliders apart, or slower";
}

}  // namespace

std::string to_string(WarningCode code) {
  switch (code) {
    case WarningCode::not_converged:
      return "not_converged";
    case WarningCode::contact_skipped:
      return "contact_skipped";
    case WarningCode::non_finite:
      return "non_finite";
    case WarningCode::cap_reached:
      return "cap_reached";
    case WarningCode::yarn_strain:
      return "yarn_strain";
    case WarningCode::flat_triangle:
      return "flat_triangle";
    case WarningCode::energy_rise:
      return "energy_rise";
    case WarningCode::crossings:
      return "crossings";
    case WarningCode::passages:
      return "passages";
    case WarningCode::open_seam:
      return "open_seam";
    case WarningCode::penetration:
      return "penetration";
    case WarningCode::infeasible:
      break;
  }
  return "infeasible";
}

std::string to_string(StepFault fault) {
  switch (fault) {
    case StepFault::stretch:
      return "stretch";
    case StepFault::collapse:
      return "collapse";
    case StepFault::energy:
      return "energy";
    case StepFault::infeasible:
      return "infeasible";
    case StepFault::skipped:
      return "skipped";
    case StepFault::non_finite:
      break;
  }
  return "non_finite";
}

std::string describe(const World& world, const StepWarning& warning) {
  const std::string what =
      describe_what(world, warning, find_integrator(world.integrator().integrator).shorter_steps);
  return warning.cloth < 0 ? what : "cloth \"" + world.name(world.cloth(warning.cloth)) + "\": " + what;
}

std::string describe(const World& world, const InfeasiblePair& pair) {
  const auto collider = [&] { return name_of_collider(world, pair.collider); };
  const auto particle = [&](int cloth, int index) {
    return "cloth \"" + world.name(world.cloth(cloth)) + "\" particle " + std::to_string(index);
  };
  const std::string first = pair.cloth < 0 ? collider() : particle(pair.cloth, pair.particle);
  if (pair.kind == InfeasibleKind::caught) return first + ", caught by " + collider() + " and another";
  return first + " and " +
         (pair.other_cloth < 0 ? collider() : particle(pair.other_cloth, pair.other_particle));
}

}  // namespace weft::engine
