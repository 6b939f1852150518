/// Public types: mistakes in scenes.

#include "weft/scene.h"

namespace weft {
namespace {

std::string list(const std::vector<Diagnostic>& diagnostics) {
  std::string lines;
  for (const Diagnostic& d : diagnostics) lines += (lines.empty() ? "" : "\n") + d.to_string();
  return lines;
}

}  // namespace

std::string Diagnostic::to_string() const {
  const std::string place =
      line > 0 ? file + ":" + std::to_string(line) + ":" + std::to_string(column) : file;
  return place + ": " + message;
}

SceneError::SceneError(std::vector<Diagnostic> diagnostics)
    : InputError(list(diagnostics)), diagnostics_(std::move(diagnostics)) {}

}  // namespace weft
