#include "lab/comparisons/peer_scripts.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "weft/scene/scene_library.h"

namespace weft::engine::lab {
namespace {

namespace fs = std::filesystem;

std::string quote(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

std::string program_of(const char* variable, const char* usual) {
  const char* chosen = std::getenv(variable);
  return quote(chosen && *chosen ? chosen : usual);
}

std::string command_of(const PeerScript& script) {
  const std::string file = quote((scene_folder().parent_path() / "tools" / "peers" / script.file).string());
  if (script.interpreter == Interpreter::python) return program_of("WEFT_PYTHON", "python3") + " " + file;
  return program_of("WEFT_BLENDER", "blender") +
         " --background --factory-startup --threads 1 --python-exit-code 1 --python " + file + " --";
}

/// Standard output of the command; empty if it fails.
std::optional<std::string> run(const std::string& command) {
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return std::nullopt;
  std::string printed;
  char buffer[256];
  while (std::fgets(buffer, sizeof buffer, pipe)) printed += buffer;
  return pclose(pipe) == 0 ? std::optional(printed) : std::nullopt;
}

/// The line that is a JSON object; some engines print other lines before and after it.
nlohmann::json find_object(const std::string& printed) {
  std::istringstream lines(printed);
  for (std::string line; std::getline(lines, line);) {
    auto json = nlohmann::json::parse(line, nullptr, false);
    if (json.is_object()) return json;
  }
  return {};
}

/// Empty if the file is too short.
std::vector<std::vector<float>> read_frames(const fs::path& file, int num_particles, int num_frames) {
  std::vector<std::vector<float>> frames(num_frames,
                                         std::vector<float>(3 * static_cast<std::size_t>(num_particles)));
  std::ifstream in(file, std::ios::binary);
  for (auto& frame : frames)
    in.read(reinterpret_cast<char*>(frame.data()),
            static_cast<std::streamsize>(frame.size() * sizeof(float)));
  if (!in.good()) frames.clear();
  return frames;
}

}  // namespace

std::optional<PeerRun> run_peer(const PeerScript& script, int num_particles, int num_frames) {
  const fs::path file = fs::temp_directory_path() / fmt::format("weft-peer-{}.f32", getpid());
  // One thread, because idle threads of OpenMP count as busy.
  const auto printed = run(fmt::format("OMP_NUM_THREADS=1 {} {} {} {} 2>/dev/null", command_of(script),
                                       script.arguments, num_frames, quote(file.string())));
  const nlohmann::json printed_result = find_object(printed.value_or(""));
  const auto frames = read_frames(file, num_particles, num_frames);
  std::error_code ignored;
  fs::remove(file, ignored);
  if (printed_result.is_null() || frames.empty()) return std::nullopt;
  return PeerRun{printed_result.at("engine"), printed_result.at("cpu_ms_per_frame"), frames};
}

}  // namespace weft::engine::lab
