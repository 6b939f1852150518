#pragma once
/// Reports as text.

#include <string>

#include "weft/run/report.h"

namespace weft::engine::app {

/// Several lines for one run.
std::string summarise(const RunReport& report);

/// A line for each problem of the run, with the setting that helps; empty if there is none.
std::string describe_problems(const RunReport& report);

/// Header and one line per run for a table of runs.
std::string table_head();
std::string table_line(const RunReport& report);

}  // namespace weft::engine::app
