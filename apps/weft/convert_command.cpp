#include <fmt/core.h>

#include <charconv>
#include <memory>

#include "commands.h"
#include "weft/error.h"
#include "weft/io.h"

namespace weft::engine::app {
namespace {

struct ConvertRequest {
  std::string in, out, up = "y", frames;
  ConvertOptions options;
};

/// A:B, A: or :B.
void set_frames(const std::string& text, ConvertOptions& options) {
  const auto number = [&](std::string_view digits) {
    int value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || value < 0)
      throw InputError("--frames " + text + ": expected FIRST:LAST, whole numbers from 0");
    return value;
  };
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) throw InputError("--frames " + text + ": expected FIRST:LAST");
  if (colon > 0) options.first_frame = number(std::string_view(text).substr(0, colon));
  if (colon + 1 < text.size()) options.last_frame = number(std::string_view(text).substr(colon + 1));
}

}  // namespace

void add_convert_command(CLI::App& app, int& exit_code) {
  auto request = std::make_shared<ConvertRequest>();
  CLI::App* command =
      app.add_subcommand("convert", "Convert a mesh, a point cache, or the point caches of a run");
  command
      ->add_option(
          "IN", request->in,
          "A mesh (.obj, .ply, .stl, .glb, .gltf), a point cache (.pc2, .mdd), or the folder of a run")
      ->required();
  command
      ->add_option("OUT", request->out,
                   "A file of the same kind: .obj or .ply; .pc2 or .mdd; of a cache also .obj or .ply, a "
                   "file per frame; of a glTF file also .pc2 or .mdd")
      ->required();
  command
      ->add_option("--mesh", request->options.mesh,
                   "The mesh of a cache's points, to write .obj or .ply; a run has its own")
      ->type_name("FILE");
  command
      ->add_option("--fps", request->options.fps,
                   "Frames per second of a cache that does not say it (default: 60)")
      ->check(CLI::PositiveNumber)
      ->type_name("N");
  command->add_option("--up", request->up, "The input's vertical axis; the output's is y")
      ->check(CLI::IsMember({"y", "z"}))
      ->capture_default_str();
  command->add_option("--scale", request->options.scale, "Length of the input's unit in metres")
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->type_name("S");
  command->add_option("--frames", request->frames, "The frames to convert, from 0, both included")
      ->type_name("A:B");
  command->callback([request, &exit_code] {
    request->options.up_is_z = request->up == "z";
    if (!request->frames.empty()) set_frames(request->frames, request->options);
    const Converted done = convert(request->in, request->out, request->options);
    for (const std::string& note : done.notes) fmt::print(stderr, "note: {}\n", note);
    for (const std::string& file : done.files) fmt::print("{}\n", file);
    exit_code = kDone;
  });
}

}  // namespace weft::engine::app
