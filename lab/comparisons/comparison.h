#pragma once
/// Comparison of engines on one hung cloth: a table with a row for each setting.

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "lab/accuracy/measure_method.h"
#include "lab/comparisons/peer_scripts.h"
#include "lab/report/sections.h"

namespace weft::engine::lab {

inline constexpr int kComparedFrames = 60;

/// One setting of an engine that a script runs.
struct PeerSetting {
  std::string solver;     // empty: the engine has one solver
  std::string words;      // the setting as text
  std::string arguments;  // of the script
  std::string how;        // model of the cloth in the engine, and missing features
};

struct Peer {
  std::string engine;
  Interpreter interpreter = Interpreter::python;
  std::string script;   // in tools/peers
  std::string install;  // installation command
  std::vector<PeerSetting> settings;
};

class Comparison {
 public:
  /// All three must outlive this; the reference has kComparedFrames.
  Comparison(const SectionOptions& options, const HungCloth& cloth, const Reference& reference);

  using Make = std::function<std::unique_ptr<Method>(const MethodSettings&, const HungCloth&)>;

  /// `engine` and `how` are cells of the table.
  void add(const MethodSettings& entry, const std::string& engine, const std::string& how, const Make& make);

  /// Adds a row per setting, or one row for an engine that does not run.
  void add(const Peer& peer);

  void add_absence(const std::string& engine, const std::string& why);

  /// Adds the time at equal error as a multiple of `newton`'s, for methods that reach it: as metrics with the
  /// given names, and as text. Then adds the table. The name of a method is that of its entry, "Engine", or
  /// "Engine's solver".
  void add_results(const std::vector<std::pair<std::string, std::string>>& figure_of_method,
                   Hypothesis& hypothesis) const;

 private:
  void add_row(const std::string& engine, const std::string& how, const MethodResult& result);
  MethodResult evaluate(const PeerRun& run) const;

  const SectionOptions& options_;
  const HungCloth& cloth_;
  const Reference& reference_;
  std::vector<MethodResult> results_;
  Table table_;
};

}  // namespace weft::engine::lab
