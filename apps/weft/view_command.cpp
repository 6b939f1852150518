#include "view_command.h"

#include <unistd.h>

#include <cstdlib>
#include <memory>

#include "apps/common/command_line.h"
#include "apps/common/progress.h"
#include "commands.h"
#include "view_open.h"
#include "viewer.h"
#include "weft/core/staged_file.h"
#include "weft/error.h"

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

}  // namespace

void view(const ViewRequest& request) {
  const ViewOptions options{
      .size = parse_size(request.size), .report = request.report, .frames = request.frames};
  if (!request.report.empty()) require_writable(request.report);
  if (!request.compare.empty() && request.scene.empty())
    throw InputError("--compare needs a scene, as in weft view drape_sphere --compare paper,newton");
  Opened opened;
  if (!request.scene.empty()) {
    opened = open_view(request);
    if (opened.fabric)
      throw InputError(request.scene + " is a fabric, not a scene: drop it on the window of a scene");
    if (opened.scene) {
      for (const std::string& warning : opened.sides[0]->live()->warnings()) say("warning: " + warning);
    }
  }
  catch_interrupts();
  lower_drawing_priority();
  Viewer(std::move(opened), request, options).run();
}

bool has_spectator() {
  return isatty(STDIN_FILENO) != 0 && (std::getenv("DISPLAY") || std::getenv("WAYLAND_DISPLAY"));
}

void add_view_command(CLI::App& app, int& exit_code) {
  auto request = std::make_shared<ViewRequest>();
  CLI::App* command = app.add_subcommand(
      "view", "Run a scene in a window in real time, and grab its cloth; or play a run back");
  command->add_option(
      "SCENE", request->scene,
      "A scene file, the name of a shipped scene, or results of weft run: the folder or its .glb "
      "(default: a gallery of the shipped scenes)");
  command
      ->add_option("--compare", request->compare,
                   "Compare two integrators or two fabrics, as in --compare paper,newton or denim,silk")
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
      ->add_option("--report", request->report, "Write what the window shows as JSON, at the end and on F12")
      ->type_name("FILE");
  add_set_option(*command, request->overrides);
  command->callback([request, &exit_code] {
    view(*request);
    exit_code = kDone;
  });
}

}  // namespace weft::engine::app
