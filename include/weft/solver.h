#pragma once
/// Solver: integrators, their budgets, division of steps, contact.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "weft/export.h"

namespace weft {

struct ExplicitSettings {
  int substeps = 0;  // per step; 0: as many as stability requires [1]
  bool operator==(const ExplicitSettings&) const = default;
};

struct PaperSettings {
  /// Uses the damping force with the sign printed in the paper, d (v_i − v_j), which amplifies motion.
  bool printed_damping_sign = false;
  bool operator==(const PaperSettings&) const = default;
};

struct ImplicitEulerSettings {
  double tolerance = 1e-2;  // Newton stops at a largest velocity change below it; smaller is slower [m/s]
  int iterations = 50;      // maximum Newton iterations per step; the report says when they run out [1]
  bool operator==(const ImplicitEulerSettings&) const = default;
};

/// Solver budget of `newton`: half or twice its automatic choice.
enum class NewtonQuality { fast, normal, high };

struct NewtonSettings {
  /// Conjugate gradient iterations per Newton step; 0: chosen from stiffness, step and mesh (about 5 for soft
  /// cloth, 10 for 2000 N/m and 60 steps per second, 20 for 20000 N/m). More is slower and closer to the
  /// exact solution [1].
  int iterations = 0;
  NewtonQuality quality = NewtonQuality::normal;  // applies only if `iterations` is 0
  bool operator==(const NewtonSettings&) const = default;
};

struct XpbdSettings {
  /// Per step. More is slower and stretches less: measured errors fall like 1/substeps, and the number needed
  /// for the same error grows with the particles per side [1].
  int substeps = 50;
  bool operator==(const XpbdSettings&) const = default;
};

struct IntegratorSettings {
  std::string integrator = "newton";  // one of integrator_names(); docs/manual/choosing.md compares them
  ExplicitSettings explicit_euler = {};
  PaperSettings paper = {};
  ImplicitEulerSettings implicit_euler = {};
  NewtonSettings newton = {};
  XpbdSettings xpbd = {};
  /// For reference solutions: also stores states in doubles. `newton` then solves its equations like
  /// `implicit_euler`, to full precision, by sparse Cholesky. Only these two support it.
  bool is_double = false;
  bool operator==(const IntegratorSettings&) const = default;
};

WEFT_API const std::vector<std::string_view>& integrator_names();

/// Step division: repeats a step in contact from its start in two parts, recursively, if it ends with excess
/// stretch, crushed triangles or an unexplained rise of energy. Later steps begin with the length that was
/// needed, and grow again when calm. An undivided step equals the step without division.
struct StepDivision {
  /// Empty: for `newton`; true: also for `implicit_euler`; other integrators never divide.
  std::optional<bool> enabled = {};

  /// Shortest part of a step. Longer is faster and less accurate in impacts: strain and intersections are
  /// then reported. > 0 [s].
  double shortest = 1.0 / 3840;
};

struct ContactSettings {
  /// Whether cloth collides with colliders, itself and other cloth. Without contact a step is cheaper, and
  /// bodies do not collide.
  bool enabled = true;

  /// Whether World::contact_points() returns the contacts of the last step. Costs some percent.
  bool tracks_points = false;
};

}  // namespace weft
