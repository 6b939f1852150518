#include <fmt/core.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "weft/run/frame_checks.h"
#include "weft/run/playback.h"

namespace weft::engine::app {
namespace {

namespace fs = std::filesystem;

struct VerifyRequest {
  fs::path path;            // a folder with animation.glb, or a .glb file
  double tolerance = 1e-4;  // [m]
  bool passages = false;    // count as failures
  bool json = false;
};

std::string count(int number, const char* one, const char* many) {
  return fmt::format("{} {}", number, number == 1 ? one : many);
}

std::string crossings_in_words(const AnimationCheck& check) {
  if (check.intersections == 0) return "no intersections";
  return fmt::format(
      "{} with intersections, at most {} in frame {}", count(check.frames_with_crossings, "frame", "frames"),
      count(check.intersections, "pair of triangles", "pairs of triangles"), check.worst_frame);
}

std::string depth_in_words(const AnimationCheck& check) {
  if (!check.penetration_max) return "no colliders with an inside";
  if (check.deepest_frame < 0) return "no cloth inside a collider";
  return fmt::format("deepest {:.3g} mm in frame {}: {}", 1000 * *check.penetration_max, check.deepest_frame,
                     check.deepest_place);
}

void print(const fs::path& file, const AnimationCheck& check) {
  fmt::print("{}: {}; {}; {}\n", file.string(), count(check.frames, "frame", "frames"),
             crossings_in_words(check), depth_in_words(check));
  for (const auto& [frame, what] : check.offences) fmt::print("  frame {}: {}\n", frame, what);
  if (check.passages == 0) {
    fmt::print("  between frames, on linear paths: no tunnelling\n");
    return;
  }
  fmt::print("  between frames, on linear paths: possible tunnelling of {}:\n",
             count(check.passages, "pair", "pairs"));
  for (const auto& [frame, what] : check.possible_passages)
    fmt::print("  before frame {}: {}\n", frame, what);
}

nlohmann::ordered_json to_json(const std::vector<AnimationCheck::Offence>& list) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const auto& [frame, what] : list) json.push_back({{"frame", frame}, {"what", what}});
  return json;
}

nlohmann::ordered_json to_json(const fs::path& file, const AnimationCheck& check) {
  const nlohmann::ordered_json null = nullptr;
  const auto frame_or_null = [&](int frame) { return frame < 0 ? null : nlohmann::ordered_json(frame); };
  return {{"file", file.string()},
          {"clean", check.is_clean},
          {"frames", check.frames},
          {"frames_with_crossings", check.frames_with_crossings},
          {"intersections", check.intersections},
          {"worst_frame", frame_or_null(check.worst_frame)},
          {"penetration_max", check.penetration_max ? nlohmann::ordered_json(*check.penetration_max) : null},
          {"deepest_frame", frame_or_null(check.deepest_frame)},
          {"deepest_place", check.deepest_frame < 0 ? null : nlohmann::ordered_json(check.deepest_place)},
          {"passages", check.passages},
          {"may_have_passed", to_json(check.possible_passages)},
          {"offences", to_json(check.offences)}};
}

/// Error in a tolerance; empty: none.
std::string require_depth(const std::string& text) {
  double depth = 0;
  if (CLI::detail::lexical_cast(text, depth) && std::isfinite(depth) && depth >= 0) return "";
  return text + " is not a depth; expected a finite number of metres, 0 or more";
}

int verify(const VerifyRequest& request) {
  const fs::path& file = request.path;
  const AnimationCheck check = check_animation(
      *open_frames(file), {.tolerance = request.tolerance, .passages_offend = request.passages});
  if (request.json) {
    const auto keep_going = nlohmann::ordered_json::error_handler_t::replace;
    fmt::print("{}\n", to_json(file, check).dump(2, ' ', false, keep_going));
  } else {
    print(file, check);
  }
  return check.is_clean ? kDone : kNotClean;
}

}  // namespace

void add_verify_command(CLI::App& app, int& exit_code) {
  auto request = std::make_shared<VerifyRequest>();
  CLI::App* command =
      app.add_subcommand("verify", "Check the frames of a run for intersections and penetration");
  command->add_option("DIR", request->path, "The folder of a run, or a .glb file that a run wrote")
      ->required();
  command->add_option("--tolerance", request->tolerance, "Tolerated penetration into colliders [m]")
      ->check(require_depth)
      ->type_name("M")
      ->capture_default_str();
  command->add_flag("--passages", request->passages,
                    "Possible tunnelling between frames also fails the check");
  command->add_flag("--json", request->json, "Print the result as JSON");
  command->footer("Exit code 0: clean. 1: intersections or excessive penetration. 2: bad input.");
  command->callback([request, &exit_code] { exit_code = verify(*request); });
}

}  // namespace weft::engine::app
