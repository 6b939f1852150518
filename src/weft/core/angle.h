#pragma once
/// Sine, cosine and arc tangent with the same bits on every machine (C libraries differ in the last bit).

namespace weft::engine {

struct SinCos {
  double sin = 0;
  double cos = 1;
};

/// Sine and cosine of an angle in degrees: exact at multiples of 90, elsewhere to about 2e-16. The angle must
/// be finite; fmod reduces large ones.
SinCos sin_cos_deg(double angle_deg);

/// Angle of the point (x, y) from the x axis, 0 to 90 degrees, with a relative error of at most 1e-15. Both are
/// 0 or more; the point's distance from the origin is between 1e-150 and 1e150.
double find_angle_deg(double y, double x);

}  // namespace weft::engine
