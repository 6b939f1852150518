#pragma once
/// How cloth moves through time: integrators, their budgets, division of steps, contact.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "weft/export.h"

namespace weft {

struct ExplicitSettings {
  int substeps = 0;  // per step; 0: as many as stability asks for [1]
};

struct PaperSettings {
  /// Use the damping force as the paper prints it, d (v_i − v_j), which feeds motion instead of damping it.
  bool printed_damping_sign = false;
};

struct ImplicitEulerSettings {
  double tolerance = 1e-2;  // Newton stops when no particle's velocity changes more; smaller is slower [m/s]
  int iterations = 50;      // Newton iterations per step at most; the report says when they run out [1]
};

/// One knob for the effort of `newton`: halves or doubles what it would choose by itself.
enum class NewtonQuality { fast, normal, high };

struct NewtonSettings {
  /// Of conjugate gradients, per Newton step; 0: chosen from stiffness, step and mesh (about 5 for soft
  /// cloth, 10 for 2000 N/m and 60 steps per second, 20 for 20000 N/m). More is slower and closer to the
  /// exact solution [1].
  int iterations = 0;
  NewtonQuality quality = NewtonQuality::normal;  // only without fixed iterations
};

struct XpbdSettings {
  /// Per step. More is slower and stretches less: by measurement the error falls like 1/substeps, and the
  /// number needed for the same error grows with the particles per side [1].
  int substeps = 50;
};

struct IntegratorSettings {
  std::string integrator = "newton";  // one of integrator_names(); docs/manual/choosing.md compares them
  ExplicitSettings explicit_euler = {};
  PaperSettings paper = {};
  ImplicitEulerSettings implicit_euler = {};
  NewtonSettings newton = {};
  XpbdSettings xpbd = {};
  /// For references: states are kept in doubles too, and `newton` then solves its equations like
  /// `implicit_euler`, to the last digits, by sparse Cholesky. Only these two have it.
  bool is_double = false;
};

WEFT_API const std::vector<std::string_view>& integrator_names();

/// Division of steps: a step in contact that comes out stretched, crushed or with more energy than it should
/// have is taken again from its start in two parts, and so on. Later steps begin with the length that was
/// needed, and join again when calm. A step that is not divided is the step that would be taken without.
struct StepDivision {
  /// Empty: for `newton`; true: for `implicit_euler` too; other integrators keep their steps.
  std::optional<bool> enabled = {};

  /// Shortest part of a step. Longer is faster and worse in impacts: strain and crossings are then reported.
  /// > 0 [s].
  double shortest = 1.0 / 960;
};

struct ContactSettings {
  /// Whether cloth collides with colliders, itself and other cloth. Without contact a step is cheaper, and
  /// everything goes through everything.
  bool enabled = true;

  /// Whether World::contact_points() has the contacts of the last step. Costs some percent.
  bool tracks_points = false;
};

}  // namespace weft
