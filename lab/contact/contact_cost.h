#pragma once
/// Cost of a frame with contact over that without.

namespace weft::engine::lab {

/// Prints a table in Markdown to standard output: scenes in which nothing, or little, touches.
void bench_contact_cost(bool quick);

}  // namespace weft::engine::lab
