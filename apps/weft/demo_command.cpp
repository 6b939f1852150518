#include <fmt/core.h>

#include <memory>

#include "commands.h"
#include "progress.h"
#include "run_command.h"
#include "summary.h"

namespace weft::app {
namespace {

/// The paper's figures, each with its twin of real fabric.
const std::vector<std::string> kScenes = {
    "paper/fig3_horizontal", "paper/fig3_horizontal_real", "paper/fig4_vertical", "paper/fig4_vertical_real",
    "paper/fig5_falling",    "paper/fig5_falling_real",    "paper/fig6_ball",     "paper/fig6_ball_real",
};

int run_demo(const std::filesystem::path& out) {
  fmt::print("The paper's four scenes, and each again with real fabric (_real).\n\n{}", table_head());
  for (const std::string& scene : kScenes) {
    const RunReport report = run_to_files({.scene = scene, .out = out / scene}).report;
    fmt::print("{}", table_line(report));
    std::fflush(stdout);
    for (const std::string& warning : report.warnings) fmt::print("  warning: {}\n", warning);
    if (report.outcome == RunOutcome::failed) fmt::print("  failed at {}\n", report.failure);
    if (report.outcome != RunOutcome::done) return exit_code_of(report.outcome);
  }
  fmt::print("\nEach scene's animation.glb and report.json are in {}: open the .glb in any glTF viewer.\n",
             (out / "paper").string());
  return kDone;
}

}  // namespace

void add_demo_command(CLI::App& app, int& exit_code) {
  auto out = std::make_shared<std::filesystem::path>("out");
  CLI::App* command = app.add_subcommand("demo", "Simulate the paper's scenes and their real-fabric twins");
  command->add_option("--out", *out, "Folder for the results")->type_name("DIR")->capture_default_str();
  command->callback([out, &exit_code] { exit_code = run_demo(*out); });
}

}  // namespace weft::app
