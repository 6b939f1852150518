#pragma once
/// Time of contact response against the number of close pairs.

namespace weft::engine::lab {

/// Prints a table of stacks of 1, 2, 4 and 8 sheets on a floor, each sheet of cells × cells. `seconds`:
/// minimum time per measurement.
void bench_response(int cells, double seconds);

}  // namespace weft::engine::lab
