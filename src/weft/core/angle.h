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

/// Of an angle of up to 1e4 in magnitude [rad], to about 2e-16.
SinCos sin_cos(double angle);

/// Angle of the point (x, y) from the x axis, in (−π, π] with a relative error of at most 1e-15; 0 of the origin
/// [rad].
double find_angle(double y, double x);

/// The same in degrees, of a point whose coordinates are 0 or more: 0 to 90.
double find_angle_deg(double y, double x);

}  // namespace weft::engine
