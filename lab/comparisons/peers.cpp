#include "lab/comparisons/peers.h"

#include <fmt/core.h>

#include <algorithm>

#include "lab/comparisons/bullet.h"
#include "lab/comparisons/comparison.h"
#include "lab/textile/specimen.h"
#include "weft/error.h"
#include "weft/world/measures.h"

namespace weft::engine::lab {
namespace {

constexpr int kQuickSide = 33;

MethodSettings with_setting(const std::string& name, const std::string& setting) {
  for (MethodSettings& entry : list_integrator_entries()) {
    if (entry.method == name && entry.setting == setting) return entry;
  }
  throw InputError("no setting " + setting + " of " + name);
}

void add_newton(Comparison& comparison, const std::string& how) {
  for (const char* setting : {"default", "default, 2 steps"})
    comparison.add(with_setting("newton", setting), "Weft, `newton`", how, make_integrator_method);
}

Reference find_explicit_reference(const HungCloth& cloth, const SectionOptions& options) {
  return find_reference(cloth, kComparedFrames,
                        options.cache.empty() ? default_cache_folder() : options.cache, options.say);
}

// ---- the engine Newton: several solvers, one script

struct NewtonSolver {
  const char* name;
  const char *argument, *cloth;  // arguments of newton_sheet.py
  const char* how;
};

constexpr NewtonSolver kNewtonXpbd = {"XPBD", "xpbd", "springs",
                                      "springs, compliance 1/k, Jacobi; no triangles"};
constexpr NewtonSolver kNewtonVbd = {"VBD", "vbd", "springs", "springs, particles in three colours"};
constexpr NewtonSolver kNewtonExplicit = {"semi-implicit", "semi_implicit", "springs",
                                          "springs, symplectic Euler"};
constexpr NewtonSolver kNewtonVbdMembrane = {
    "VBD", "vbd", "membrane",
    "stable neo-Hookean triangles, tri_ke = tri_ka = 1000 N/m: equal for small strain"};
constexpr NewtonSolver kNewtonStyle3d = {
    "Style3D", "style3d", "membrane",
    "triangles, ku = kv = 2667, ks = 1000 N/m: no springs, no Poisson's ratio; damps velocities by 0.2 % per "
    "substep"};

struct NewtonSetting {
  NewtonSolver solver;
  int substeps;
  int iterations = 0;  // per substep; 0: the solver has none
};

Peer describe_newton(int side, const std::vector<NewtonSetting>& settings) {
  Peer peer{.engine = "Newton", .script = "newton_sheet.py", .install = "`pip install newton`, $WEFT_PYTHON"};
  for (const auto& [solver, substeps, iterations] : settings) {
    std::string words = fmt::format("{} substeps", substeps);
    if (iterations > 0) words += fmt::format(" of {} iteration{}", iterations, iterations == 1 ? "" : "s");
    peer.settings.push_back(
        {solver.name, words,
         fmt::format("{} {} {} {} {}", side, solver.cloth, solver.argument, substeps, iterations),
         solver.how});
  }
  return peer;
}

// ---- the same springs

Hypothesis compare_springs(const SectionOptions& options) {
  Hypothesis hypothesis{.title = "The hanging sheet of springs: Bullet's soft body, Newton",
                        .source = "Weft"};
  const int side = options.quick ? kQuickSide : 64;
  const HungCloth cloth = make_hung_sheet(side, "simplified", {});
  const Reference reference = find_explicit_reference(cloth, options);
  hypothesis.text = {fmt::format(
      "{0}×{0} particles of 0.2 kg/m², springs of 2000, 1000 and 20 N/m, hung by two corners, no contact, no "
      "damping, one thread; a second. Error: mean RMS distance from `explicit` at a quarter of its limit. The "
      "error of this reference is {1:.4f} m, its worst strain {2:.1f} %. Times are those of the fastest of "
      "up to three runs. Newton is the engine of that name, on Warp, here without the graphics card that it is "
      "made for. Its first setting of each solver, here and below, is that of Newton's example of hanging "
      "cloth.",
      side, reference.error, 100 * reference.strain)};
  Comparison comparison(options, cloth, reference);
  add_newton(comparison, "springs");
  for (const char* setting : {"50 substeps", "100 substeps", "200 substeps"})
    comparison.add(with_setting("xpbd", setting), "Weft, `xpbd`", "springs, compliance 1/k",
                   make_integrator_method);
  for (const MethodSettings& entry : list_bullet_entries())
    comparison.add(
        entry, "Bullet 3",
        "links; stiffness C/(W + 1/(h²k)), which is XPBD's; one position iteration per substep, no drag",
        make_bullet_method);
  if (list_bullet_entries().empty())
    comparison.add_absence("Bullet", "this Weft was built without it (libbullet-dev)");
  std::vector<NewtonSetting> settings = {{kNewtonXpbd, 10, 10}, {kNewtonXpbd, 100, 1},
                                         {kNewtonVbd, 10, 10},  {kNewtonVbd, 40, 5},
                                         {kNewtonExplicit, 32}, {kNewtonExplicit, 200}};
  if (!options.quick)
    settings = {{kNewtonXpbd, 10, 10}, {kNewtonXpbd, 100, 1},  {kNewtonXpbd, 200, 1}, {kNewtonXpbd, 400, 1},
                {kNewtonVbd, 10, 10},  {kNewtonVbd, 40, 5},    {kNewtonVbd, 40, 10},  {kNewtonVbd, 20, 40},
                {kNewtonExplicit, 32}, {kNewtonExplicit, 200}, {kNewtonExplicit, 400}};
  comparison.add(describe_newton(side, settings));
  comparison.add_results({{"Bullet", "bullet_over_newton"},
                          {"Newton's XPBD", "warp_xpbd_over_newton"},
                          {"Newton's VBD", "warp_vbd_over_newton"},
                          {"Newton's semi-implicit", "warp_semi_implicit_over_newton"}},
                         hypothesis);
  return hypothesis;
}

// ---- the same membrane

/// Without bending: Young's modulus times thickness 8000/3 N/m, Poisson's ratio 1/3.
HungCloth make_hung_membrane(int side) {
  const Fabric fabric{.density = 0.2,
                      .c11 = 3000,
                      .c22 = 3000,
                      .c12 = 1000,
                      .g = 1000,
                      .bend_warp = 0,
                      .bend_weft = 0,
                      .bend_bias = 0,
                      .damping = 0};
  const Specimen sheet =
      make_rectangle(fabric, {.cells_x = side - 1, .cells_z = side - 1}, SpecimenMesh::grid);
  HungCloth cloth{"membrane", sheet.model, sheet.state, {}};
  for (const int p : {0, side - 1}) {
    cloth.environment.pins.particle.push_back(p);
    cloth.environment.pins.position.push_back(sheet.rest()[p]);
  }
  return cloth;
}

/// By newton in short steps, of second order: the error with half as many is four thirds of their distance.
Reference make_membrane_reference(const HungCloth& cloth) {
  constexpr int kSteps = 64;
  Reference reference;
  for (const int steps : {kSteps, kSteps / 2}) {
    MethodSettings entry{.method = "newton", .steps_per_frame = steps};
    entry.settings.newton.quality = NewtonQuality::high;
    const auto method = make_integrator_method(entry, cloth);
    for (int f = 0; f < kComparedFrames; ++f) {
      method->advance_frame();
      if (steps == kSteps) {
        reference.frames.push_back(frame_of(method->state()));
        reference.strain = std::max(reference.strain, compute_strain(*cloth.model, method->state()).max);
      } else {
        reference.error += distance_from(reference.frames[f], method->state()) / kComparedFrames;
      }
    }
  }
  return reference;
}

Peer describe_mujoco(int side, bool quick) {
  Peer peer{.engine = "MuJoCo", .script = "mujoco_sheet.py", .install = "`pip install mujoco`, $WEFT_PYTHON"};
  const auto add = [&](const std::string& integrator, int steps) {
    peer.settings.push_back({"", fmt::format("{}, {} step{}", integrator, steps, steps == 1 ? "" : "s"),
                             fmt::format("{} {} {}", side, steps, integrator),
                             "flex, dim 2, elastic2d stretch; times include Python"});
  };
  for (const int steps : {1, 4, 16}) add("discrete", steps);
  if (!quick) add("Euler", 100);
  return peer;
}

Hypothesis compare_membranes(const SectionOptions& options) {
  Hypothesis hypothesis{.title = "The hanging membrane: MuJoCo's flex, Newton", .source = "Weft"};
  const HungCloth cloth = make_hung_membrane(kQuickSide);
  options.report_progress("membrane: reference");
  const Reference reference = make_membrane_reference(cloth);
  hypothesis.text = {fmt::format(
      "{0}×{0} particles of 0.2 kg/m² as an isotropic membrane of triangles: Young's modulus times thickness "
      "2667 N/m, Poisson's ratio 1/3, no bending. The sheet hangs from two corners; no contact, no damping, "
      "one thread; a second. Error: mean RMS distance from `newton` at `high` with 64 steps per frame; with 32 "
      "steps the distance is {1:.4f} m. MuJoCo's grid has parallel diagonals, ours alternating ones, and its "
      "particles at borders have the full mass. Some millimetres of its error come from these differences. "
      "Newton has our mesh and masses.",
      kQuickSide, reference.error)};
  Comparison comparison(options, cloth, reference);
  add_newton(comparison, "triangles");
  comparison.add(describe_mujoco(kQuickSide, options.quick));
  std::vector<NewtonSetting> settings = {{kNewtonVbdMembrane, 10, 10}, {kNewtonStyle3d, 2, 10}};
  if (!options.quick)
    settings = {{kNewtonVbdMembrane, 10, 10}, {kNewtonVbdMembrane, 40, 10}, {kNewtonVbdMembrane, 20, 40},
                {kNewtonStyle3d, 2, 10},      {kNewtonStyle3d, 10, 4},      {kNewtonStyle3d, 4, 100}};
  comparison.add(describe_newton(kQuickSide, settings));
  comparison.add_results({{"MuJoCo", "mujoco_over_newton"},
                          {"Newton's VBD", "warp_vbd_membrane_over_newton"},
                          {"Newton's Style3D", "warp_style3d_over_newton"}},
                         hypothesis);
  return hypothesis;
}

// ---- equal springs

/// All particles have the same mass; every edge, including diagonals, is a spring of 2000 N/m.
HungCloth make_even_sheet(int side) {
  HungCloth cloth = make_hung_sheet(side, "simplified", {});
  ClothTopology topology = *cloth.model->topology;
  topology.area.assign(topology.area.size(), 1.0 / static_cast<double>(topology.area.size()));
  cloth.model = build_cloth_model(std::make_shared<ClothTopology>(topology), {.shear = 2000, .bend = 0});
  cloth.name += ", even";
  return cloth;
}

Peer describe_blender(int side, bool quick) {
  Peer peer{.engine = "Blender",
            .interpreter = Interpreter::blender,
            .script = "blender_sheet.py",
            .install = "blender, $WEFT_BLENDER"};
  for (const int steps : quick ? std::vector{5, 20} : std::vector{5, 20, 80})
    peer.settings.push_back(
        {"", fmt::format("quality {}", steps), fmt::format("{} {}", side, steps),
         "edges; tension and compression k times their mean length, angular bending 0; conjugate gradients to "
         "1 %; times include the whole frame change"});
  return peer;
}

Hypothesis compare_even_springs(const SectionOptions& options) {
  Hypothesis hypothesis{.title = "The hanging sheet of equal springs: Blender's cloth", .source = "Weft"};
  const HungCloth cloth = make_even_sheet(kQuickSide);
  const Reference reference = find_explicit_reference(cloth, options);
  hypothesis.text = {fmt::format(
      "Blender's cloth has one stiffness for all edges, its shear springs do not resist compression, and its "
      "particles have equal masses. Here all springs, along edges and one diagonal of each cell, therefore "
      "have 2000 N/m, without bending. All {0}×{0} particles have equal masses, 0.2 kg together. The springs "
      "are exactly those of Blender. Its unit of time is the frame: gravity and stiffness are given per "
      "frame², for 60 frames per second. Quality is its number of steps per frame, 5 by default. Other settings "
      "as above. The error of the reference is {1:.4f} m, its worst strain {2:.1f} %.",
      kQuickSide, reference.error, 100 * reference.strain)};
  Comparison comparison(options, cloth, reference);
  add_newton(comparison, "springs");
  comparison.add(describe_blender(kQuickSide, options.quick));
  comparison.add_results({{"Blender", "blender_over_newton"}}, hypothesis);
  return hypothesis;
}

Hypothesis what_was_not_measured() {
  Hypothesis hypothesis{.title = "Engines that are not measured", .source = "Weft"};
  hypothesis.found.tables = {
      {{"engine", "reason"}, {{"NvCloth, Jolt, PositionBasedDynamics", "no packages for Debian or PyPI"}}}};
  return hypothesis;
}

}  // namespace

Section study_peers(const SectionOptions& options) {
  Section section{.name = "peers",
                  .title = "The same cloth in other engines",
                  .introduction =
                      "Each engine simulates the same cloth, or the nearest that it supports, with the settings "
                      "that its authors would use. The tables list the settings."};
  section.hypotheses = {compare_springs(options), compare_membranes(options), compare_even_springs(options),
                        what_was_not_measured()};
  return section;
}

}  // namespace weft::engine::lab
