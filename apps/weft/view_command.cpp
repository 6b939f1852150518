#include "view_command.h"

#include <unistd.h>

#include <cstdlib>
#include <memory>

#include "apps/common/command_line.h"
#include "apps/common/progress.h"
#include "commands.h"
#include "viewer.h"
#include "weft/core/staged_file.h"
#include "weft/error.h"
#include "weft/scene/scene_library.h"
#include "weft/scene/scene_reader.h"

#ifdef __linux__
#include <sys/resource.h>
#endif

namespace weft::engine::app {
namespace {

/// Lowers the priority of this thread, and of those that it creates, below the simulation's: with software
/// OpenGL, pictures are late rather than steps.
void lower_drawing_priority() {
#ifdef __linux__
  constexpr int kNiceness = 4;
  setpriority(PRIO_PROCESS, 0, kNiceness);  // on Linux: of the calling thread
#endif
}

/// One simulation, or one per integrator to compare. They share the processors, except one for drawing.
std::vector<std::unique_ptr<ViewSide>> make_sides(const ViewRequest& request, SceneDesc scene) {
  std::vector<std::string> integrators = request.compare;
  if (integrators.empty()) integrators = {scene.solver.integrator};
  const int count = static_cast<int>(integrators.size());
  const int threads =
      request.threads > 0 ? choose_threads(request.threads) : std::max(1, (num_processors() - 1) / count);
  std::vector<std::unique_ptr<ViewSide>> sides;
  for (const std::string& name : integrators) {
    scene.solver.integrator = name;
    make_integrator(scene.solver);  // throws before a scene is built
    sides.push_back(std::make_unique<LiveSide>(scene, threads));
  }
  return sides;
}

/// The folder of a run, or a .glb file; else the request is for a scene.
bool is_run(const std::string& path) {
  return std::filesystem::is_directory(path) || std::filesystem::path(path).extension() == ".glb";
}

std::vector<std::unique_ptr<ViewSide>> open_run(const ViewRequest& request) {
  const auto refuse = [&](bool is_given, const char* option) {
    if (is_given)
      throw InputError(std::string(option) + " does not apply to " + request.scene +
                       ": it is already simulated");
  };
  refuse(!request.overrides.empty(), "--set");
  refuse(!request.compare.empty(), "--compare");
  refuse(request.threads > 0, "--threads");
  std::vector<std::unique_ptr<ViewSide>> sides;
  sides.push_back(std::make_unique<RunSide>(request.scene));
  return sides;
}

std::vector<std::unique_ptr<ViewSide>> open_scene(const ViewRequest& request) {
  const SceneDesc scene = read_scene(find_scene(request.scene), request.overrides);
  std::vector<std::unique_ptr<ViewSide>> sides = make_sides(request, scene);
  for (const std::string& warning : sides[0]->live()->warnings()) say("warning: " + warning);
  return sides;
}

}  // namespace

void view(const ViewRequest& request) {
  const ViewOptions options{
      .size = parse_size(request.size), .report = request.report, .frames = request.frames};
  if (!request.report.empty()) require_writable(request.report);
  std::vector<std::unique_ptr<ViewSide>> sides =
      is_run(request.scene) ? open_run(request) : open_scene(request);
  catch_interrupts();
  lower_drawing_priority();
  Viewer(std::move(sides), options).run();
}

bool has_spectator() {
  return isatty(STDIN_FILENO) != 0 && (std::getenv("DISPLAY") || std::getenv("WAYLAND_DISPLAY"));
}

void add_view_command(CLI::App& app, int& exit_code) {
  auto request = std::make_shared<ViewRequest>();
  CLI::App* command = app.add_subcommand(
      "view", "Run a scene in a window in real time, and grab its cloth; or play a run back");
  command
      ->add_option(
          "SCENE", request->scene,
          "A scene file, the name of a shipped scene, or results of weft run: the folder or its .glb")
      ->required();
  command
      ->add_option("--compare", request->compare,
                   "Compare two integrators, as in --compare paper,paper_fixed")
      ->delimiter(',')
      ->expected(2)
      ->type_name("A,B");
  command->add_option("--size", request->size, "Window size in pixels")
      ->type_name("WxH")
      ->capture_default_str();
  command
      ->add_option("--threads", request->threads,
                   "Threads of each simulation (default: all processors except one for drawing)")
      ->check(CLI::Range(1, 1024))
      ->type_name("T");
  command->add_option("--frames", request->frames, "Close the window after N pictures")
      ->check(CLI::Range(1, 1000000000))
      ->type_name("N");
  command
      ->add_option("--report", request->report,
                   "Write what the window shows as JSON, at the end and on the key J")
      ->type_name("FILE");
  add_set_option(*command, request->overrides);
  command->callback([request, &exit_code] {
    view(*request);
    exit_code = kDone;
  });
}

}  // namespace weft::engine::app
