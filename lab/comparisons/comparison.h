#pragma once
/// One hung cloth moved by many engines, a row of a table for each setting.

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "lab/comparisons/peer_scripts.h"
#include "lab/report/sections.h"
#include "lab/accuracy/measure_method.h"

namespace weft::engine::lab {

inline constexpr int kComparedFrames = 60;

/// One setting of an engine that a script drives.
struct PeerSetting {
  std::string solver;     // of several that the engine has; empty: it has one
  std::string words;      // the setting
  std::string arguments;  // of the script
  std::string how;        // the cloth is given, and what the engine cannot do
};

struct Peer {
  std::string engine;
  Interpreter interpreter = Interpreter::python;
  std::string script;   // in tools/peers
  std::string install;  // how
  std::vector<PeerSetting> settings;
};

class Comparison {
 public:
  /// All three must outlive it; the reference has kComparedFrames.
  Comparison(const SectionOptions& options, const HungCloth& cloth, const Reference& reference);

  using Make = std::function<std::unique_ptr<Method>(const MethodSettings&, const HungCloth&)>;

  /// `engine` and `how` as the table says them.
  void add(const MethodSettings& entry, const std::string& engine, const std::string& how,
           const Make& make);

  /// One row that says so if it does not run.
  void add(const Peer& peer);

  void add_absence(const std::string& engine, const std::string& why);

  /// How many times as long as `newton` the methods take to be as right, as key figures of the given names
  /// and in words; of those that are as right at any setting. Then the table. A method is called as its
  /// entry calls it, or "Engine", or "Engine's solver".
  void tell(const std::vector<std::pair<std::string, std::string>>& figure_of_method, Hypothesis& hypothesis) const;

 private:
  void add_row(const std::string& engine, const std::string& how, const MethodResult& result);
  MethodResult judge(const PeerRun& run) const;

  const SectionOptions& options_;
  const HungCloth& cloth_;
  const Reference& reference_;
  std::vector<MethodResult> results_;
  Table table_;
};

}  // namespace weft::engine::lab
