#pragma once
/// How right a method moves a hung cloth, and for how much processor time.

#include <functional>
#include <optional>

#include "lab/accuracy/method.h"
#include "lab/report/plot.h"
#include "lab/accuracy/reference.h"

namespace weft::engine::lab {

/// At which methods are compared: 4 cm in a swing of a metre is hard to see [m].
inline constexpr double kEqualError = 0.045;

/// From the reference in any frame: the cloth has flown apart [m].
inline constexpr double kLargeError = 10;

struct MethodResult {
  std::string method, setting;
  double cpu_ms = 0;  // per frame
  double error = 0;   // mean over the frames of the RMS distance from the reference [m]
  double strain = 0;  // the largest of all frames [1]
  bool ok = true;     // false: it flew apart
};

using MakeMethod = std::function<std::unique_ptr<Method>()>;

/// Runs all frames of the reference; the fastest of a few runs counts, for others may be using the machine.
MethodResult measure_method(const MakeMethod& make, const MethodSettings& entry,
                                 const HungCloth& cloth, const Reference& reference);

/// How far a result is from what is asked for: 1 is just as good.
using Objective = std::function<double(const MethodResult&)>;

/// The processor time at which a method is just as good as asked for, between two settings by straight lines
/// on logarithmic axes; that of its cheapest setting if even this is better; empty if none is as good [ms].
std::optional<double> find_time(const std::string& method, const std::vector<MethodResult>& results,
                                const Objective& objective);

/// Error against time, a series per method; what flew apart is left out.
PlotPanel make_panel(const std::string& title, const std::vector<MethodResult>& results);

}  // namespace weft::engine::lab
