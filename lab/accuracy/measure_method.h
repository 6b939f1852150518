#pragma once
/// Error and processor time of a method for a hung cloth.

#include <functional>
#include <optional>

#include "lab/accuracy/method.h"
#include "lab/accuracy/reference.h"
#include "lab/report/plot.h"

namespace weft::engine::lab {

/// Error at which methods are compared: 4 cm in a swing of a metre is hard to see [m].
inline constexpr double kEqualError = 0.045;

/// Distance from the reference in a frame at which a method has diverged [m].
inline constexpr double kLargeError = 10;

struct MethodResult {
  std::string method, setting;
  double cpu_ms = 0;  // per frame
  double error = 0;   // mean over the frames of the RMS distance from the reference [m]
  double strain = 0;  // maximum over all frames [1]
  bool ok = true;     // false: it diverged
};

using MakeMethod = std::function<std::unique_ptr<Method>()>;

/// Runs all frames of the reference. The fastest of a few runs counts, because of other processes.
MethodResult measure_method(const MakeMethod& make, const MethodSettings& entry, const HungCloth& cloth,
                            const Reference& reference);

/// Ratio of a result to the required quality: at most 1 meets it.
using Objective = std::function<double(const MethodResult&)>;

/// The processor time at which a method meets the objective exactly, by log-log interpolation between two
/// settings. If its cheapest setting is better, that setting's time; empty if no setting meets it [ms].
std::optional<double> find_time(const std::string& method, const std::vector<MethodResult>& results,
                                const Objective& objective);

/// Error against time, a series per method, without diverged results.
PlotPanel make_panel(const std::string& title, const std::vector<MethodResult>& results);

}  // namespace weft::engine::lab
