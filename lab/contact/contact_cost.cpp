#include "lab/contact/contact_cost.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "weft/run/stopwatch.h"
#include "weft/scene/scene_library.h"
#include "weft/scene/scene_reader.h"
#include "weft/scene/scene_world.h"
#include "weft/world/world.h"

namespace weft::engine::lab {
namespace {

constexpr int kFramesPerSecond = 60;
constexpr int kRuns = 3;  // the fastest counts

/// A row of the table.
struct CostCase {
  std::string name;
  std::function<World(bool contact)> make;
  int frames = 60;
  int steps_per_frame = 1;
};

/// Processor time of a phase [s].
struct Cost {
  double with = 0, without = 0;
  int frames = 0;

  Cost& keep_faster(const Cost& run) {
    if (frames == 0) *this = run;
    with = std::min(with, run.with);
    without = std::min(without, run.without);
    return *this;
  }
};

/// Before the first frame with a contact, and from it on.
struct Costs {
  Cost before, after;
};

/// Steps `world` by a frame and returns the number of its contacts. Adds the processor time to `seconds`.
std::size_t step_timed(World& world, int steps, double& seconds) {
  Stopwatch watch;
  watch.start();
  std::size_t active = 0;
  for (int s = 0; s < steps; ++s) active += world.step(1.0 / (kFramesPerSecond * steps)).work.active;
  watch.stop();
  seconds += watch.cpu_total();
  return active;
}

/// Both worlds step interleaved, so that both have the same changes of the machine's speed.
Costs measure_once(const CostCase& own) {
  World with = own.make(true), without = own.make(false);
  Costs costs;
  bool has_touched = false;
  for (int f = 0; f < own.frames; ++f) {
    double seconds = 0;
    has_touched |= step_timed(with, own.steps_per_frame, seconds) > 0;
    Cost& cost = has_touched ? costs.after : costs.before;
    cost.with += seconds;
    step_timed(without, own.steps_per_frame, cost.without);
    ++cost.frames;
  }
  return costs;
}

void print_cost(const std::string& name, const char* phase, const Cost& cost) {
  if (cost.frames == 0) return;
  fmt::print("| {} | {} | {} | {:.2f} | {:.2f} | {:.2f} |\n", name, phase, cost.frames,
             1000 * cost.without / cost.frames, 1000 * cost.with / cost.frames, cost.with / cost.without);
}

void bench_case(const CostCase& own) {
  Costs best;
  for (int run = 0; run < kRuns; ++run) {
    const Costs costs = measure_once(own);
    best.before.keep_faster(costs.before);
    best.after.keep_faster(costs.after);
  }
  print_cost(own.name, "before", best.before);
  print_cost(own.name, "after", best.after);
  std::fflush(stdout);
}

World hang_or_drop_sheet(int particles, bool hangs, bool contact) {
  World world;
  world.set_contact(contact);
  const int cells = particles - 1;
  const ClothId sheet = world.add_cloth(
      {.name = "sheet",
       .topology = build_grid_topology({.size_x = 1, .size_z = 1, .cells_x = cells, .cells_z = cells},
                                       SpringModel::alternating),
       .material = {.density = 0.2, .structural = 2000, .shear = 1000, .bend = 20}});
  if (hangs) world.set_pins(sheet, {Pin{.particles = {0, cells}}});
  return world;
}

/// Sheets above each other, 1 cm apart.
World drop_sheets(int count, bool contact) {
  World world;
  world.set_contact(contact);
  const auto topology =
      build_grid_topology({.size_x = 1, .size_z = 1, .cells_x = 8, .cells_z = 8}, SpringModel::alternating);
  for (int k = 0; k < count; ++k) {
    std::vector<Vec3> positions = topology->mesh.positions;
    for (Vec3& p : positions) p.y() += 0.01 * k;
    world.add_cloth({.name = fmt::format("sheet {}", k),
                     .topology = topology,
                     .material = {.density = 0.2, .structural = 2000, .shear = 1000, .bend = 20},
                     .positions = positions});
  }
  return world;
}

CostCase shipped_scene(const std::string& name, int frames) {
  const SceneDesc scene = read_scene(find_scene(name));
  const auto make = [scene](bool contact) {
    SceneDesc own = scene;
    own.contact = contact;
    return build_world(own, make_serial_jobs()).world;
  };
  return {name, make, frames, scene.steps_per_frame};
}

}  // namespace

void bench_contact_cost(bool quick) {
  fmt::print(
      "## Overhead of contact\n\n"
      "Processor time of a frame with contact over that of the same world without contact, `newton`, one "
      "thread; both\nstep interleaved, the fastest of {} runs. Sheets of 1 m without damping. `before` and "
      "`after` "
      "the first\nframe with a contact.\n\n"
      "| what | phase | frames | without ms | with ms | ratio |\n|---|---|--:|--:|--:|--:|\n",
      kRuns);
  std::vector<CostCase> cases;
  for (const int particles : {64, 128}) {
    if (quick && particles > 64) continue;
    for (const bool hangs : {true, false})
      cases.push_back({fmt::format("{} sheet {}²", hangs ? "hung" : "falling", particles),
                       [=](bool contact) { return hang_or_drop_sheet(particles, hangs, contact); },
                       hangs ? 120 : 60});
  }
  for (const int count : {100, 300}) {
    if (quick && count > 100) continue;
    cases.push_back({fmt::format("{} falling sheets of 9², 1 cm apart", count),
                     [=](bool contact) { return drop_sheets(count, contact); }, 30});
  }
  for (const char* name : {"flag", "garment_hung", "paper/fig5_falling", "paper/fig6_ball"})
    cases.push_back(shipped_scene(name, quick ? 60 : 180));
  for (const CostCase& own : cases) bench_case(own);
  fmt::print("\n");
}

}  // namespace weft::engine::lab
