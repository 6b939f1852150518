#pragma once
/// Mistakes in a scene file, each with file, line and column.

#include <string>
#include <vector>

#include "weft/error.h"

namespace weft::engine {

/// One mistake: "FILE:LINE:COLUMN: mistake, expected value".
struct Diagnostic {
  std::string file;          // an override's is "--set path.to.key"
  int line = 0, column = 0;  // from 1; 0: not in a file
  std::string message;       // a sentence

  std::string to_string() const;
};

/// A scene file with mistakes; what() lists all of them, one per line.
class SceneError : public InputError {
 public:
  explicit SceneError(std::vector<Diagnostic> diagnostics);
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

}  // namespace weft::engine
