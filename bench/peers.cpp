#include "bench/peers.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "bench/bullet.h"
#include "weft/core/error.h"
#include "weft/lab/contest.h"
#include "weft/lab/specimen.h"
#include "weft/world/measures.h"

namespace weft::bench {
namespace {

constexpr int kFrames = 60;

std::vector<std::string> row_of(const std::string& engine, const ContestResult& r,
                                const std::string& settings) {
  if (!r.ok) return {engine, r.setting, settings, "flies apart", "", ""};
  return {engine,
          r.setting,
          settings,
          fmt::format("{:.2f}", r.cpu_ms),
          fmt::format("{:.4f}", r.error),
          fmt::format("{:.1f}", 100 * r.strain)};
}

const std::vector<std::string> kHead = {"engine",           "setting",  "how the cloth is given",
                                        "CPU ms per frame", "error, m", "worst strain, %"};

// ---- the same springs: Bullet

ContestantSettings with_setting(const std::string& name, const std::string& setting) {
  for (ContestantSettings& entry : list_integrator_entries()) {
    if (entry.method == name && entry.setting == setting) return entry;
  }
  throw InputError("no setting " + setting + " of " + name);
}

Claim springs_in_bullet(const ChapterOptions& options) {
  Claim claim{.title = "The hanging sheet of springs: Bullet's soft body", .source = "Weft"};
  const int side = options.quick ? 33 : 64;
  const HungCloth cloth = make_hung_sheet(side, "simplified", {});
  const Reference reference = find_reference(
      cloth, kFrames, options.cache.empty() ? default_cache_folder() : options.cache, options.say);
  claim.text = {
      fmt::format("{0}×{0} particles of 0.2 kg/m², springs of 2000, 1000 and 20 N/m, hung by two corners, no "
                  "contact, no damping, one thread; a second. "
                  "Error: mean RMS distance from `explicit` at a quarter of its limit, known to {1:.4f} m; "
                  "its worst strain is {2:.1f} %. The fastest of up to three "
                  "runs.",
                  side, reference.error, 100 * reference.strain)};
  claim.tables = {{kHead, {}}};
  std::vector<ContestResult> results;
  const auto add = [&](const ContestantSettings& entry, const std::string& engine, const std::string& how,
                       const auto& make) {
    options.tell(engine + ", " + entry.setting);
    results.push_back(measure_contestant([&] { return make(entry, cloth); }, entry, cloth, reference));
    claim.tables[0].rows.push_back(row_of(engine, results.back(), how));
  };
  for (const char* setting : {"default", "default, 2 steps"})
    add(with_setting("newton", setting), "Weft, `newton`", "springs", make_integrator_contestant);
  for (const char* setting : {"50 substeps", "100 substeps", "200 substeps"})
    add(with_setting("xpbd", setting), "Weft, `xpbd`", "springs, compliance 1/k", make_integrator_contestant);
  for (const ContestantSettings& entry : list_bullet_entries())
    add(entry, "Bullet 3",
        "links; stiffness C/(W + 1/(h²k)), which is XPBD's; one position iteration per substep, no drag",
        make_bullet_contestant);
  const auto by_error = [](const ContestResult& r) { return r.error / kEqualError; };
  const auto newton = find_time("newton", results, by_error), bullet = find_time("Bullet", results, by_error);
  if (list_bullet_entries().empty())
    claim.tables[0].rows.push_back(
        {"Bullet", "", "not there when this Weft was built (libbullet-dev)", "", "", ""});
  if (newton && bullet) {
    claim.figures = {{"bullet_over_newton", *bullet / *newton, "1", "> 1", 0}};
    claim.text.push_back(fmt::format("At an error of {} m Bullet takes {:.0f} times as long as `newton`.",
                                     kEqualError, *bullet / *newton));
  }
  return claim;
}

// ---- the same membrane: MuJoCo

struct PeerRun {
  std::string engine;
  double cpu_ms = 0;
  std::vector<std::vector<float>> frames;
};

std::string shell_quote(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

/// Runs one of tools/peers, which prints a line of JSON and leaves frames in a file; nothing if it cannot.
std::optional<PeerRun> run_peer(const std::string& script, const std::string& arguments, int particles) {
  const char* chosen = std::getenv("WEFT_PYTHON");
  const std::string python = chosen && *chosen ? chosen : "python3";
  const auto file = std::filesystem::temp_directory_path() /
                    fmt::format("weft-peer-{:x}.f32", reinterpret_cast<std::uintptr_t>(&python));
  const std::string command = shell_quote(python) + " " +
                              shell_quote(std::string(WEFT_PEERS) + "/" + script) + " " + arguments + " " +
                              shell_quote(file.string()) + " 2>/dev/null";
  std::string printed;
  if (FILE* pipe = popen(command.c_str(), "r")) {
    char buffer[256];
    while (std::fgets(buffer, sizeof buffer, pipe)) printed += buffer;
    if (pclose(pipe) != 0) return std::nullopt;
  }
  const auto json = nlohmann::json::parse(printed, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  PeerRun run{json.at("engine"), json.at("cpu_ms_per_frame"), {}};
  std::ifstream in(file, std::ios::binary);
  run.frames.assign(kFrames, std::vector<float>(3 * static_cast<std::size_t>(particles)));
  for (auto& frame : run.frames)
    in.read(reinterpret_cast<char*>(frame.data()),
            static_cast<std::streamsize>(frame.size() * sizeof(float)));
  const bool is_whole = in.good();
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  return is_whole ? std::optional(run) : std::nullopt;
}

/// A membrane without bending: Young's modulus times thickness 8000/3 N/m, Poisson's ratio 1/3.
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
      make_rectangle(fabric, {.cells_x = side - 1, .cells_z = side - 1}, SpecimenMesh::grid, 0);
  HungCloth cloth{"membrane", sheet.model, sheet.state, {}};
  for (const int p : {0, side - 1}) {
    cloth.environment.pins.particle.push_back(p);
    cloth.environment.pins.position.push_back(sheet.rest()[p]);
  }
  return cloth;
}

/// By newton in short steps: of second order, so that half as many show four thirds of its error.
Reference make_membrane_reference(const HungCloth& cloth) {
  constexpr int kSteps = 64;
  Reference reference;
  for (const int steps : {kSteps, kSteps / 2}) {
    ContestantSettings entry{.method = "newton", .steps_per_frame = steps};
    entry.settings.newton.quality = NewtonQuality::high;
    const auto contestant = make_integrator_contestant(entry, cloth);
    for (int f = 0; f < kFrames; ++f) {
      contestant->advance_frame();
      if (steps == kSteps) {
        reference.frames.push_back(frame_of(contestant->state()));
        reference.strain = std::max(reference.strain, compute_strain(*cloth.model, contestant->state()).max);
      } else {
        reference.error += distance_from(reference.frames[f], contestant->state()) / kFrames;
      }
    }
  }
  return reference;
}

ContestResult judge(const PeerRun& run, const std::string& setting, const HungCloth& cloth,
                    const Reference& reference) {
  ContestResult result{.method = run.engine, .setting = setting, .cpu_ms = run.cpu_ms};
  ClothState state = cloth.state;
  for (int f = 0; f < kFrames; ++f) {
    const std::vector<float>& x = run.frames[f];
    for (std::size_t i = 0; i < state.x.size(); ++i)
      state.set_position(i, {x[3 * i], x[3 * i + 1], x[3 * i + 2]});
    result.error += distance_from(reference.frames[f], state) / kFrames;
    result.strain = std::max(result.strain, compute_strain(*cloth.model, state).max);
  }
  result.ok = result.error < 10;
  return result;
}

Claim membrane_in_mujoco(const ChapterOptions& options) {
  Claim claim{.title = "The hanging membrane: MuJoCo's flex", .source = "Weft"};
  const int side = 33;
  const HungCloth cloth = make_hung_membrane(side);
  options.tell("membrane: reference");
  const Reference reference = make_membrane_reference(cloth);
  claim.text = {
      fmt::format("{0}×{0} particles of 0.2 kg/m², an isotropic membrane of triangles (Young's modulus times "
                  "thickness 2667 N/m, Poisson's ratio 1/3, no bending), hung by two corners, no "
                  "contact, no damping, one thread; a second. Error: mean RMS distance from `newton` at "
                  "`high` with 64 steps per frame; half as many differ from it by {1:.4f} m. "
                  "MuJoCo's grid has all diagonals parallel, ours alternate, and its particles weigh the "
                  "same at borders: some millimetres of its error are that.",
                  side, reference.error)};
  claim.tables = {{kHead, {}}};
  std::optional<double> newton, mujoco;
  for (const auto& [setting, steps] : {std::pair{"default", 1}, {"default, 2 steps", 2}}) {
    const ContestantSettings entry{.method = "newton", .setting = setting, .steps_per_frame = steps};
    const ContestResult r =
        measure_contestant([&] { return make_integrator_contestant(entry, cloth); }, entry, cloth, reference);
    claim.tables[0].rows.push_back(row_of("Weft, `newton`", r, "triangles"));
    if (steps == 2) newton = r.cpu_ms;
  }
  struct Setting {
    const char* integrator;
    int steps;
  };
  const std::vector<Setting> settings =
      options.quick ? std::vector<Setting>{{"discrete", 1}}
                    : std::vector<Setting>{{"discrete", 1}, {"discrete", 4}, {"Euler", 100}};
  for (const auto& [integrator, steps] : settings) {
    const std::string words = fmt::format("{}, {} step{}", integrator, steps, steps == 1 ? "" : "s");
    options.tell("MuJoCo, " + words);
    const auto run = run_peer("mujoco_sheet.py", fmt::format("{} {} {} {}", side, steps, integrator, kFrames),
                              side * side);
    if (!run) {
      claim.tables[0].rows.push_back(
          {"MuJoCo", words, "not installed here (`pip install mujoco`, $WEFT_PYTHON)", "", "", ""});
      continue;
    }
    const ContestResult r = judge(*run, words, cloth, reference);
    claim.tables[0].rows.push_back(
        row_of(run->engine, r, "flex, dim 2, elastic2d stretch; Python's own time is in the frame"));
    if (steps == 1) mujoco = r.cpu_ms;
  }
  if (newton && mujoco)
    claim.figures = {{"mujoco_discrete_over_newton_2_steps", *mujoco / *newton, "1", "> 1", 0}};
  return claim;
}

Claim what_was_not_measured() {
  Claim claim{.title = "What was not measured", .source = "Weft"};
  claim.tables = {{{"engine", "why"},
                   {{"Blender's cloth",
                     "its springs take no stiffness in N/m, and it has no way to run without its own frame "
                     "clock: no driver is written"},
                    {"Newton (Python, Warp)", "no driver is written"},
                    {"NvCloth, Jolt, PositionBasedDynamics", "no packages for Debian or PyPI"}}}};
  return claim;
}

}  // namespace

Chapter study_peers(const ChapterOptions& options) {
  Chapter chapter{.name = "peers",
                  .title = "Other engines, the same cloth",
                  .introduction =
                      "Each engine gets the same cloth or the nearest it knows, with the settings that its "
                      "authors would use for it; they stand in the tables."};
  chapter.claims = {springs_in_bullet(options), membrane_in_mujoco(options), what_was_not_measured()};
  return chapter;
}

}  // namespace weft::bench
