#pragma once
/// Sine and cosine with the same bits on every machine (C libraries differ in the last bit).

namespace weft::engine {

struct SinCos {
  double sin = 0;
  double cos = 1;
};

/// Sine and cosine of an angle in degrees: exact at multiples of 90, elsewhere to about 2e-16. The angle must
/// be finite; fmod reduces large ones.
SinCos sin_cos_deg(double angle_deg);

}  // namespace weft::engine
