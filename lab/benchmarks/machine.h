#pragma once
/// Rates of the machine, measured in the same run as the kernels that they are compared with.

#include <cstddef>

namespace weft::engine::lab {

/// Memory bandwidth of `num_threads` threads, read plus write [bytes/s]. Each element of a working set of
/// `bytes` is read, changed and written (x[i] = a x[i] + b); the best of a few tries.
double measure_bandwidth(std::size_t bytes, int num_threads);

/// Floats per second that one thread loads in whole vector registers from its first-level cache.
double measure_loads();

/// Floats per second that one thread adds or multiplies in whole vector registers.
double measure_arithmetic();

/// The same for square roots and divisions, half of each.
double measure_roots_and_divisions();

/// Clock frequency under load [Hz], from a chain of dependent additions; 0: not available.
double measure_clock();

/// Resident memory of this process [bytes]; 0: not available (other systems than Linux).
double resident_bytes();

/// A monotonic clock [s].
double seconds_now();

}  // namespace weft::engine::lab
