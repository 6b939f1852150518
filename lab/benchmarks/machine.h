#pragma once
/// What the machine can do, measured in the same run as what is compared with it.

#include <cstddef>

namespace weft::engine::lab {

/// Bytes per second that `num_threads` threads read and write together when each array element of a working
/// set of `bytes` is read, changed and written (x[i] = a x[i] + b): the best of a few tries.
double measure_bandwidth(std::size_t bytes, int num_threads);

/// Floats per second that one thread loads in whole vector registers from its first-level cache.
double measure_loads();

/// Floats per second that one thread adds or multiplies in whole vector registers.
double measure_arithmetic();

/// The same for square roots and divisions, half of each.
double measure_roots_and_divisions();

/// Clock frequency under load [Hz], from a chain of dependent additions; 0 where it cannot be measured.
double measure_clock();

/// Memory of this process that is in use [bytes]; 0 where it cannot be told (only Linux tells it).
double resident_bytes();

/// A clock that never goes back [s].
double seconds_now();

}  // namespace weft::engine::lab
