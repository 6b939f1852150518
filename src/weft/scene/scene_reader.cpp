#include "weft/scene/scene_reader.h"

#include <algorithm>
#include <climits>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <system_error>

#include "weft/scene/scene_sections.h"
#include "weft/scene/unsupported.h"

namespace weft::engine {
namespace {

/// The path below a folder called "scenes", else the stem.
std::string make_name(const std::filesystem::path& file) {
  std::error_code no_current_folder;
  const std::filesystem::path path = std::filesystem::absolute(file, no_current_folder).lexically_normal();
  std::filesystem::path name;
  bool is_below_scenes = false;
  for (const std::filesystem::path& part : path.parent_path()) {
    if (part == "scenes") {
      is_below_scenes = true;
      name.clear();
    } else if (is_below_scenes) {
      name /= part;
    }
  }
  return (name / file.stem()).generic_string();
}

void read_format(TomlTable& table) {
  table.require({"format"}, "format = 1");
  const TomlValue format = table.get("format", {.kind = ParameterKind::choice, .choices = {"1"}});
  const bool is_known = format && format.node().value_exact<std::int64_t>() == 1;
  if (format && !is_known) format.expected("1, the only format that this version reads");
}

void read_scene_table(TomlTable table, SceneDesc& scene) {
  constexpr double kMaxFrames = 1e7;
  read_format(table);
  table.read("description", scene.description);
  table.read("gravity", scene.gravity, any_number("m/s²"), "[0, -9.81, 0]");
  table.read("fps", scene.fps, above_zero("frames per second"));
  table.read("duration", scene.duration, above_zero("s"));
  table.read("settle", scene.settle, not_negative("s"));
  if (scene.duration * scene.fps > kMaxFrames) {
    const TomlValue duration = table.get("duration"), fps = table.get("fps");
    (duration ? duration : fps).mistake("duration times fps is more than 10 million frames");
  }
}

std::vector<WindKey> read_wind_keys(TomlTable& table) {
  std::vector<WindKey> keys;
  for (TomlTable& entry : table.tables("keys")) {
    WindKey key;
    const bool is_in_order = read_time(entry, keys, key);
    entry.require({"velocity"}, "3 numbers in m/s");
    entry.read("velocity", key.velocity, any_number("m/s"));
    if (is_in_order) keys.push_back(key);
  }
  return keys;
}

void read_air(TomlTable& wind, WindDesc& desc) {
  TomlTable air = wind.table("air");
  desc.air.density = 1.2;
  air.read("density", desc.air.density, above_zero("kg/m³"));
  air.read("drag", desc.air.drag, above_zero());
  desc.air.lift = std::min(desc.air.lift, desc.air.drag);
  if (air.read("lift", desc.air.lift, not_negative()) && desc.air.lift > desc.air.drag)
    air.get("lift").mistake("must not exceed drag: otherwise the air would add energy");
}

void read_gusts(TomlTable& wind, WindDesc& desc) {
  TomlTable gusts = wind.table("gusts");
  gusts.require({"strength"}, "a number not below 0 in m/s");
  gusts.read("strength", desc.gusts.strength, not_negative("m/s"));
  gusts.read("length", desc.gusts.length, above_zero("m"));
  gusts.read("time", desc.gusts.time, above_zero("s"));
  int seed = 1;
  gusts.read("seed", seed, IntegerRule{0, INT_MAX});
  desc.gusts.seed = static_cast<std::uint64_t>(seed);
}

WindDesc read_wind(TomlTable table) {
  WindDesc wind;
  table.require_any({"drag", "air"}, "drag = 0.25 in N·s/m³, or air = {}");
  if (table.has("air")) read_air(table, wind);
  if (table.has("gusts") && !table.has("air")) table.get("gusts").mistake("requires air: add air = {}");
  if (table.has("gusts")) read_gusts(table, wind);
  table.require({"velocity", "keys"},
                "velocity = [1, 0, 0] in m/s, or keys = [{ time = 0, velocity = [1, 0, 0] }, …]");
  table.read("drag", wind.drag, not_negative("N·s/m³"));
  WindKey steady;
  const bool is_steady = table.read("velocity", steady.velocity, any_number("m/s"));
  wind.keys = read_wind_keys(table);
  if (is_steady) wind.keys = {steady};
  const TomlValue keys = table.get("keys");
  if (keys && keys.node().is_array() && keys.node().as_array()->empty()) keys.expected("at least one key");
  return wind;
}

bool has_cloth(const SceneDesc& scene, const std::string& name) {
  return std::any_of(scene.cloths.begin(), scene.cloths.end(), [&](const auto& c) { return c.name == name; });
}

bool has_collider(const SceneDesc& scene, const std::string& name) {
  return std::any_of(scene.colliders.begin(), scene.colliders.end(),
                     [&](const auto& c) { return c.name == name; });
}

ContactDesc read_contact(TomlTable& table, const SceneDesc& scene) {
  constexpr std::string_view kForm = "two names of cloths or colliders, as in [\"sheet\", \"ball\"]";
  ContactDesc contact;
  table.require({"between"}, kForm);
  table.read("collide", contact.collide);
  const TomlValue friction = table.get("friction", make_note(not_negative()));
  if (double number = 0; friction && friction.read(number, not_negative())) contact.friction = number;
  read_static_friction(table, contact.friction.value_or(0), contact.static_friction);
  if (contact.static_friction > 0 && !friction) table.get("static_friction").mistake("requires friction");
  const TomlValue between = table.get("between", {.kind = ParameterKind::texts, .length = 2});
  if (!between) return contact;
  const std::vector<TomlValue> names = between.elements(kForm);
  if (names.size() != 2) {
    between.expected(kForm);
    return contact;
  }
  for (int n = 0; n < 2; ++n) {
    std::string& name = contact.between[n];
    if (names[n].read(name) && !has_cloth(scene, name) && !has_collider(scene, name))
      names[n].mistake("no cloth or collider is named \"" + name + "\"");
  }
  if (has_collider(scene, contact.between[0]) && has_collider(scene, contact.between[1]))
    between.mistake("one of the two must be a cloth; colliders do not collide with each other");
  return contact;
}

void read_integrator(TomlTable& solver, std::string& integrator) {
  const std::vector<std::string> names(integrator_names().begin(), integrator_names().end());
  const int choice = solver.find_choice("integrator", names, integrator);
  if (choice >= 0) integrator = names[choice];
}

void check_integrator(TomlTable& solver, const SceneDesc& scene) {
  const std::string& integrator = scene.solver.integrator;
  for (const auto& [key, sentence] : find_unsupported(scene, integrator))
    solver.get(key).mistake(key == "integrator" ? sentence : integrator + ' ' + sentence);
}

/// A number applies to the integrator in use; "auto" leaves the choice to it.
void read_iterations(TomlTable& solver, IntegratorSettings& settings) {
  constexpr IntegerRule kRule{1, INT_MAX};
  Parameter note = make_note(kRule);
  note.choices = {quote("auto")};
  note.default_value = note.choices[0];
  const TomlValue value = solver.get("iterations", std::move(note));
  if (!value) return;
  int iterations = 0;
  if (value.is_string()) {
    if (value.node().value_exact<std::string_view>() != "auto") value.expected("a whole number or \"auto\"");
  } else if (value.read(iterations, kRule)) {
    settings.implicit_euler.iterations = settings.newton.iterations = iterations;
  }
}

void read_adaptive(TomlTable& solver, SceneDesc& scene) {
  const TomlValue value = solver.get("adaptive", {.kind = ParameterKind::flag});
  bool is_adaptive = false;
  if (!value || !value.read(is_adaptive)) return;
  scene.adaptive = is_adaptive;
}

void read_solver(TomlTable table, SceneDesc& scene) {
  IntegratorSettings& solver = scene.solver;
  read_integrator(table, solver.integrator);
  table.read("steps_per_frame", scene.steps_per_frame, IntegerRule{1, 100000});
  read_adaptive(table, scene);
  table.read("max_steps_per_frame", scene.max_steps_per_frame, IntegerRule{1, 4096});
  read_iterations(table, solver);
  table.read_choice<NewtonQuality>(
      "quality", solver.newton.quality,
      {{"fast", NewtonQuality::fast}, {"default", NewtonQuality::normal}, {"high", NewtonQuality::high}});
  table.read_choice<bool>("precision", solver.is_double, {{"single", false}, {"double", true}});
  check_integrator(table, scene);
  table.read("tolerance", solver.implicit_euler.tolerance, above_zero("m/s"));
  table.read("contact", scene.contact);
  table.read("untangle", scene.untangle);
  table.read_choice<CrossedStart>("crossed_start", scene.crossed_start,
                                  {{"refuse", CrossedStart::refuse}, {"allow", CrossedStart::allow}});
  table.table("explicit").read("substeps", solver.explicit_euler.substeps, IntegerRule{0, INT_MAX});
  table.table("paper").read_choice<bool>("damping_sign", solver.paper.printed_damping_sign,
                                         {{"corrected", false}, {"as_printed", true}});
  table.table("xpbd").read("substeps", solver.xpbd.substeps, IntegerRule{1, 100000});
}

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& message) {
  throw SceneError({{file.generic_string(), 0, 0, message}});
}

}  // namespace

std::string read_scene_text(const std::filesystem::path& file) {
  std::error_code not_there;
  if (std::filesystem::is_directory(file, not_there)) fail(file, "expected a scene file, found a folder");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail(file, "cannot be opened");
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (stream.bad()) fail(file, "cannot be read");
  return text;
}

SceneDesc read_document(TomlDocument& document, const std::filesystem::path& file) {
  SceneDesc scene;
  scene.name = make_name(file);
  TomlTable root(document, &document.root(), "");
  root.require({"scene"}, "[scene] with format = 1");
  root.require({"cloth"}, "at least one [[cloth]]");
  read_scene_table(root.table("scene"), scene);
  for (TomlTable& cloth : root.tables("cloth")) {
    scene.cloths.push_back(read_cloth(cloth, static_cast<int>(scene.cloths.size()) + 1, file.parent_path()));
  }
  for (TomlTable& collider : root.tables("collider")) {
    scene.colliders.push_back(
        read_collider(collider, static_cast<int>(scene.colliders.size()) + 1, file.parent_path()));
    const PlacedMesh* mesh = std::get_if<PlacedMesh>(&scene.colliders.back().shape);
    if (mesh && !mesh->rest.empty() && scene.settle == 0)
      collider.get("rest").mistake(
          "needs scene.settle, the time in which the mesh moves from there to its first pose");
  }
  for (TomlTable& contact : root.tables("contact")) scene.contacts.push_back(read_contact(contact, scene));
  scene.wind = read_wind(root.table("wind"));
  read_solver(root.table("solver"), scene);
  return scene;
}

SceneDesc read_scene(const std::filesystem::path& file, const Overrides& overrides) {
  return parse_scene(read_scene_text(file), file, overrides);
}

SceneDesc parse_scene(std::string_view text, const std::filesystem::path& file, const Overrides& overrides) {
  TomlDocument document(text, file.generic_string());
  for (const std::string& assignment : overrides) document.override_value(assignment);
  SceneDesc scene = read_document(document, file);
  std::vector<Diagnostic> mistakes = document.finish();
  if (!mistakes.empty()) throw SceneError(std::move(mistakes));
  return scene;
}

}  // namespace weft::engine
