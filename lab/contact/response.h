#pragma once
/// What it costs to hold cloth apart, by the number of pairs that are close.

namespace weft::engine::lab {

/// Prints a table of stacks of 1, 2, 4 and 8 sheets on a floor, each sheet of cells × cells; `seconds` per
/// measurement, at least.
void bench_response(int cells, double seconds);

}  // namespace weft::engine::lab
