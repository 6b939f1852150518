#include "lab/contact/contact_benchmark.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <string_view>
#include <tuple>

#include "lab/benchmarks/machine.h"
#include "lab/contact/contact_cost.h"
#include "lab/contact/contact_experiments.h"
#include "weft/run/scene_run.h"
#include "weft/scene/scene_library.h"
#include "weft/scene/scene_reader.h"
#include "weft/scene/scene_world.h"
#include "weft/world/measures.h"
#include "weft/world/world.h"

namespace weft::engine::lab {
namespace {

constexpr int kQuickFrames = 20;
constexpr int kFineSteps = 16;  // per frame, for reference strains
constexpr double kTableFriction = 0.1, kSheetFriction = 0.3;

std::vector<std::string> shipped_scenes() {
  std::vector<std::string> names;
  for (const ShippedScene& scene : list_scenes()) {
    if (scene.name.starts_with("contact/")) names.push_back(scene.name);
  }
  return names;
}

/// Wall time of the frames of a run [ms].
struct FrameTimes {
  double mean = 0, worst = 0;
};

RunReport bench_scene(const std::string& name, int frames, int threads) {
  const SceneDesc scene = read_scene(find_scene(name));
  FrameTimes times;
  double spent = 0;
  const RunOptions options{.frames = frames > 0 ? std::min(frames, scene.num_frames()) : scene.num_frames(),
                           .threads = threads};
  const RunReport report = run_scene(scene, options, {}, [&](const Progress& progress) {
    times.worst = std::max(times.worst, 1000 * (progress.seconds_spent - spent));
    spent = progress.seconds_spent;
    times.mean = 1000 * spent / progress.frame;
    return true;
  });
  const std::string depth =
      report.penetration_max ? fmt::format("{:.2g}", *report.penetration_max) : std::string("–");
  fmt::print("| {} | {} | {} | {} | {:.1f} | {:.1f} | {} | {} | {} | {} | {} | {} |\n", name,
             report.particles, report.frames, threads, times.mean, times.worst,
             report.intersections.value_or(-1), report.passages.value_or(-1), depth,
             report.infeasible ? report.infeasible->size() : 0, report.contact_hits.value_or(0),
             report.contact_zones.value_or(0));
  std::fflush(stdout);
  return report;
}

/// A row with shares of the time of steps by kind of work, and counts.
void print_work(const RunReport& report) {
  const WorkTimes& w = report.work;
  fmt::print("| {} | {} | {:.2f} |", report.scene, report.threads, 1000 * w.total / report.frames);
  for (const double seconds : {w.lists, w.narrow_phase, w.rows, w.set_up, w.product, w.v_cycle, w.projection,
                               w.ccd, w.total - w.kinds(), w.retries})
    fmt::print(" {:.1f} |", 100 * seconds / w.total);
  fmt::print(" {} |", w.pairs_listed);
  for (const std::size_t count : {w.pairs_tested, w.active, w.list_renewals, w.looks})
    fmt::print(" {:.1f} |", static_cast<double>(count) / report.frames);
  fmt::print("\n");
}

void print_where_frames_go(const std::vector<RunReport>& reports) {
  fmt::print(
      "## Time of a frame by kind of work\n\n"
      "Shares of the time of steps in %, on the calling thread. `retries` are discarded parts of steps, and are "
      "included in the other shares too. Pairs in the longest list of the run, and counts per frame.\n\n"
      "| scene | threads | ms | lists | narrow phase | rows | set up | product | V-cycle | projection | CCD "
      "| "
      "rest | retries | longest list | tested | active | renewals | looks |\n"
      "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
  for (const RunReport& report : reports) {
    if (report.frames > 0) print_work(report);
  }
  fmt::print("\n");
}

/// Returns whether there are no intersections and no passages.
bool bench_scenes(const ContactBenchOptions& options) {
  fmt::print(
      "## Scenes\n\n"
      "| scene | particles | frames | threads | mean ms | worst ms | intersections | passages | penetration "
      "m | "
      "infeasible | hits | zones |\n"
      "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
  std::vector<RunReport> reports;
  const int frames = options.frames > 0 ? options.frames : options.quick ? kQuickFrames : 0;
  for (const std::string& name : options.scenes.empty() ? shipped_scenes() : options.scenes) {
    for (const int threads : options.threads) reports.push_back(bench_scene(name, frames, threads));
  }
  fmt::print("\n");
  print_where_frames_go(reports);
  return std::all_of(reports.begin(), reports.end(), [](const RunReport& report) {
    return report.outcome == RunOutcome::done && report.intersections == 0 && report.passages == 0;
  });
}

/// Cost of a stack of sheets on a floor.
struct LayerCost {
  double ms = 0, ms_without = 0;  // per step, with contact and without
  double contacts = 0;            // number with a force
  double speed = 0;               // residual jitter (RMS) [m/s]
};

/// RMS speed over all particles, weighted by mass [m/s].
double speed_of(const World& world) {
  double kinetic = 0, mass = 0;
  for (int c = 0; c < world.num_cloths(); ++c) {
    const ClothModel& model = world.model(world.cloth(c));
    kinetic += compute_kinetic_energy(model, world.state(world.cloth(c)));
    mass += std::accumulate(model.mass.begin(), model.mass.end(), 0.0);
  }
  return std::sqrt(2 * kinetic / mass);
}

LayerCost measure_layers(int layers, int cells) {
  constexpr double kSize = 0.64, kThickness = 1e-3;
  constexpr int kSettle = 60, kSteps = 20;
  LayerCost cost;
  for (const bool contact : {true, false}) {
    World world;
    world.set_contact(contact);
    if (!contact) world.set_gravity(Vec3::Zero());
    world.add_collider({"floor", Plane{}, 0.3, {}});
    const auto topology = build_grid_topology(
        {.size_x = kSize, .size_z = kSize, .cells_x = cells, .cells_z = cells}, SpringModel::alternating);
    for (int k = 0; k < layers; ++k) {
      const Mat3 turn = rotation_from_angles_deg({0, 7.0 * k, 0});
      std::vector<Vec3> positions;
      for (const Vec3& p : topology->mesh.positions)
        positions.push_back(turn * (p - Vec3(kSize / 2, 0, kSize / 2)) + Vec3(0, (k + 0.5) * kThickness, 0));
      world.add_cloth({.name = "layer",
                       .topology = topology,
                       .material = {.structural = 2000, .shear = 1000, .bend = 20, .thickness = kThickness},
                       .positions = positions});
    }
    for (int s = 0; s < kSettle; ++s) world.step(1.0 / 60);
    const double start = seconds_now();
    for (int s = 0; s < kSteps; ++s) world.step(1.0 / 60);
    (contact ? cost.ms : cost.ms_without) = 1000 * (seconds_now() - start) / kSteps;
    if (!contact) continue;
    world.track_contacts(true);
    world.step(1.0 / 60);
    cost.contacts = static_cast<double>(world.contact_points().size());
    for (int s = 0; s < kSteps; ++s) {
      world.step(1.0 / 60);
      cost.speed += speed_of(world) / kSteps;
    }
  }
  return cost;
}

void bench_layers(bool quick) {
  const int cells = quick ? 24 : 48;
  fmt::print(
      "## Cost against the number of contacts\n\n"
      "Stacks of sheets of {0}×{0} cells on a floor, `newton`, one thread; without contact there is no "
      "gravity.\n\n"
      "| layers | loaded contacts | jitter mm/s | ms per step | without contact | µs per contact | |\n"
      "|--:|--:|--:|--:|--:|--:|---|\n",
      cells);
  for (const int layers : {1, 2, 3, 4, 6, 8}) {
    const LayerCost cost = measure_layers(layers, cells);
    const double each = 1000 * (cost.ms - cost.ms_without) / cost.contacts;
    fmt::print("| {} | {:.0f} | {:.2f} | {:.1f} | {:.2f} | {:.2f} | {} |\n", layers, cost.contacts,
               1000 * cost.speed, cost.ms, cost.ms_without, each,
               std::string(static_cast<std::size_t>(std::min(60.0, 10 * each)), '#'));
    std::fflush(stdout);
  }
  fmt::print("\n");
}

/// Memory per particle of contact/ball_and_floor after a second [bytes].
double measure_memory(int cells) {
  SceneDesc scene = read_scene(find_scene("contact/ball_and_floor"));
  Grid& grid = std::get<Grid>(scene.cloths.at(0).shape);
  grid.cells_x = grid.cells_z = cells;
  const double before = resident_bytes();
  World world = build_world(scene, make_serial_jobs()).world;
  for (int s = 0; s < scene.fps; ++s) world.step(1.0 / scene.fps);
  return (resident_bytes() - before) / grid.num_particles();
}

void bench_memory(bool quick) {
  const int cells = quick ? 127 : 255;
  fmt::print("contact/ball_and_floor with {0}×{0} particles: {1:.0f} bytes per particle after a second.\n\n",
             cells + 1, measure_memory(cells));
  std::fflush(stdout);
}

void bench_rest(double seconds) {
  fmt::print(
      "## Rest\n\n"
      "A sheet of 0.8 m dropped from 1 cm: results of the second half of {} s. `speed`: median of the root mean "
      "square. `rise`: maximum rise of the middle in a step, over the whole time. `force`: mean of the contact "
      "forces over the weight.\n\n"
      "| on | cells | speed mm/s | kinetic energy J/kg | drift mm | rise mm | force |\n"
      "|---|--:|--:|--:|--:|--:|--:|\n",
      seconds);
  for (const auto& [name, support, cells] :
       {std::tuple("a floor", Support::floor, 32), std::tuple("a ball", Support::ball, 8),
        std::tuple("a ball", Support::ball, 16), std::tuple("a ball", Support::ball, 24),
        std::tuple("a ball", Support::ball, 32), std::tuple("a ball", Support::ball, 48)}) {
    const RestingSheet rest = rest_on({.cells = cells}, support, seconds);
    fmt::print("| {} | {} | {:.2f} | {:.2g} | {:.3f} | {:.4f} | {:.4f} |\n", name, cells, 1000 * rest.speed,
               rest.kinetic, 1000 * rest.drift, 1000 * rest.rise, rest.force);
    std::fflush(stdout);
  }
  fmt::print("\n");
}

void bench_laws(const ContactExperiment& setup) {
  fmt::print("## Friction\n\n| experiment | µ | measured | predicted | error |\n|---|--:|--:|--:|--:|\n");
  for (const double friction : {0.0, 0.2, 0.4, 0.566, 0.59}) {
    const Slide slide = slide_on_incline(setup, 30, friction);
    const std::string off = slide.expected > 0
                                ? fmt::format("{:+.1f} %", 100 * (slide.acceleration / slide.expected - 1))
                                : std::string("–");
    fmt::print("| incline of 30° (tan = 0.577), m/s² | {} | {:.3f} | {:.3f} | {} |\n", friction,
               slide.acceleration, slide.expected, off);
  }
  for (const double friction : {0.1, 0.3, 0.5}) {
    for (const Drum drum : {Drum::capsule, Drum::cloth}) {
      const Capstan capstan = pull_over_drum(setup, friction, drum);
      fmt::print("| capstan{}, half a turn, ratio of tensions | {} | {:.3f} | {:.3f} | {:+.1f} % |\n",
                 drum == Drum::cloth ? " of cloth" : "", friction, capstan.ratio, capstan.expected,
                 100 * (capstan.ratio / capstan.expected - 1));
    }
  }
  for (const double friction : {0.02, 0.03, 0.6}) {
    const Spin spin = spin_ball(setup, friction);
    fmt::print("| ball, rotates by {:.2f} rad: the sheet, rad | {} | {:.3f} | {:.3f} | {:+.1f} % |\n",
               spin.turned_ball, friction, spin.turned_sheet, spin.expected,
               100 * (spin.turned_sheet / spin.expected - 1));
  }
  for (const double acceleration : {4.0, 20.0}) {
    const Turntable table = turn_table(setup, kTableFriction, acceleration);
    fmt::print("| turntable at {} rad/s²: the sheet, rad/s² | {} | {:.3f} | {:.3f} | {:+.1f} % |\n",
               acceleration, kTableFriction, table.acceleration, table.expected,
               100 * (table.acceleration / table.expected - 1));
  }
  for (const double acceleration : {1.0, 2.0, 4.0, 6.0, 10.0}) {
    const CarriedSheet sheet = carry_sheet(setup, kSheetFriction, acceleration);
    fmt::print("| sheet on a sheet at {} m/s²: the upper one, m/s² | {} | {:.3f} | {:.3f} | {:+.1f} % |\n",
               acceleration, kSheetFriction, sheet.acceleration, sheet.expected,
               100 * (sheet.acceleration / sheet.expected - 1));
  }
  std::fflush(stdout);
}

/// Coulomb's law contact by contact, and for the sheet as a whole.
void bench_friction_audit(const ContactExperiment& setup, bool quick) {
  fmt::print(
      "\nSums over the sliding contacts of all steps: Σ|T| over µ ΣN; torque about the axis over µ Σ N r,\n"
      "from contact forces and from angular momentum. 1: Coulomb's law.\n\n"
      "| experiment | cells | µ | measured over predicted | Σ\\|T\\| | torque, contacts | torque, momentum |\n"
      "|---|--:|--:|--:|--:|--:|--:|\n");
  const auto print_row = [](const char* what, int cells, double friction, double share,
                            const FrictionAudit& f, double torque) {
    fmt::print("| {} | {} | {} | {:.3f} | {:.2f} | {:.3f} | {:.3f} |\n", what, cells, friction, share,
               f.tangential / f.limit, f.torque / f.torque_limit, torque);
    std::fflush(stdout);
  };
  const Turntable table = turn_table(setup, kTableFriction, 20);
  print_row("turntable at 20 rad/s²", setup.cells, kTableFriction, table.acceleration / table.expected,
            table.friction, table.torque);
  const CarriedSheet sheet = carry_sheet(setup, kSheetFriction, 6);
  fmt::print("| sheet on a sheet at 6 m/s² | {} | {} | {:.3f} | {:.2f} | – | – |\n", setup.cells,
             kSheetFriction, sheet.acceleration / sheet.expected,
             sheet.friction.tangential / sheet.friction.limit);
  for (const double friction : {0.02, 0.03}) {
    for (const int cells : {8, 16, 24, 32, 48, 64}) {
      if (quick && cells == 64) continue;
      ContactExperiment own = setup;
      own.cells = cells;
      const Spin spin = spin_ball(own, friction);
      print_row("rotating ball", cells, friction, spin.turned_sheet / spin.expected, spin.friction,
                spin.torque);
    }
  }
}

void bench_momentum(const ContactExperiment& setup) {
  const FoldedFall fall = drop_fold(setup, 0.5);
  const Collision collision = collide_sheets(setup, 0.5);
  fmt::print(
      "\n## Momentum\n\n"
      "A folded sheet in free fall gains g h of mean velocity per step, with an error of at most {:.4f} % in "
      "half a second.\nTwo free sheets that collide (up to {} contacts) change their total momentum by {:.1g} of "
      "one sheet's.\n",
      100 * std::abs(fall.worst_gain - 1), collision.contacts, collision.momentum_change);
}

/// Maximum rise of energy in a frame of a scene without external drive, except for the first frame.
struct EnergyRise {
  double rise = 0;    // [J]
  int frame = 0;      // of the rise; 0: there is none
  double fallen = 0;  // gravitational energy lost until then [J]
};

EnergyRise find_energy_rise(const RunReport& report) {
  EnergyRise worst;
  const std::vector<double>& height = report.energy.gravitational;
  const auto total = [&](int f) { return report.kinetic_energy[f] + report.potential_energy[f]; };
  for (int f = 1; f < report.frames; ++f) {
    const double rise = total(f) - total(f - 1);
    if (rise > worst.rise) worst = {rise, f + 1, height[0] - height[f]};
  }
  return worst;
}

/// `frames` 0: all.
void bench_energy_of(const char* name, const char* damping, const Overrides& overrides, int frames) {
  SceneDesc scene = read_scene(find_scene(name), overrides);
  const RunOptions options{.frames = frames > 0 ? frames : scene.num_frames()};
  scene.steps_per_frame = 1;
  const RunReport coarse = run_scene(scene, options);
  scene.steps_per_frame = kFineSteps;
  const RunReport fine = run_scene(scene, options);
  const EnergyRise worst = find_energy_rise(coarse);
  fmt::print("| {} | {} | {} | {:.3g} | {} | {:.2f} % | {:+.1f} % | {:+.1f} % |\n", name, damping,
             coarse.frames, worst.rise, worst.frame, worst.fallen > 0 ? 100 * worst.rise / worst.fallen : 0.0,
             100 * coarse.max_strain, 100 * fine.max_strain);
  std::fflush(stdout);
}

void bench_energy(bool quick) {
  fmt::print(
      "\n## Energy\n\n"
      "Without external drive, every rise of kinetic plus potential energy is an error. Results with one step "
      "per frame:\nlargest rise in a frame, its share of the released gravitational energy, worst strain of "
      "structural springs.\nThe last column is the worst strain with {0} steps per frame.\n\n"
      "| scene | damping | frames | rise J | in frame | share | strain | {0} steps |\n"
      "|---|---|--:|--:|--:|--:|--:|--:|\n",
      kFineSteps);
  const int frames = quick ? 100 : 0;
  bench_energy_of("paper/fig3_horizontal_real", "as shipped", {}, frames);
  bench_energy_of("paper/fig3_horizontal_real", "none", {"cloth[0].fabric.damping=0"}, frames);
  bench_energy_of("paper/fig5_falling_real", "as shipped", {}, frames);
  bench_energy_of("garment_fall", "as shipped", {}, frames);
}

}  // namespace

bool bench_contact(const ContactBenchOptions& options) {
  const auto is_chosen = [&](std::string_view section) {
    return options.sections.empty() || std::ranges::find(options.sections, section) != options.sections.end();
  };
  const ContactExperiment setup{.cells = options.quick ? 16 : 32};
  bool is_clean = true;
  // First, because memory that other benchmarks have freed does not count.
  if (is_chosen("memory")) bench_memory(options.quick);
  if (is_chosen("scenes")) is_clean = bench_scenes(options);
  if (is_chosen("overhead")) bench_contact_cost(options.quick);
  if (is_chosen("layers")) bench_layers(options.quick);
  if (is_chosen("rest")) bench_rest(options.quick ? 4 : 20);
  if (is_chosen("friction")) {
    bench_laws(setup);
    bench_friction_audit(setup, options.quick);
  }
  if (is_chosen("momentum")) bench_momentum(setup);
  if (is_chosen("energy")) bench_energy(options.quick);
  return is_clean;
}

}  // namespace weft::engine::lab
