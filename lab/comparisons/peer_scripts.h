#pragma once
/// Other engines through tools/peers: scripts that simulate a hung sheet and write its frames to a file.

#include <optional>
#include <string>
#include <vector>

namespace weft::engine::lab {

enum class Interpreter {
  python,   // $WEFT_PYTHON, else python3
  blender,  // $WEFT_BLENDER, else blender
};

struct PeerScript {
  Interpreter interpreter = Interpreter::python;
  std::string file;       // in tools/peers
  std::string arguments;  // before the number of frames and the file; documented in the script
};

struct PeerRun {
  std::string engine;                      // with its version
  double cpu_ms = 0;                       // per frame, the fastest of up to three runs
  std::vector<std::vector<float>> frames;  // as in Reference
};

/// Runs the script on one thread. Empty if it fails, for example because its engine is not installed.
std::optional<PeerRun> run_peer(const PeerScript& script, int num_particles, int num_frames);

}  // namespace weft::engine::lab
