#pragma once
/// Private to verify/: squared distances between points, segments and triangles [m²]. They may be degenerate.

#include "weft/verify/crossings.h"

namespace weft::engine::verify {

struct Segment {
  Vec3 from, to;
};

double distance_sq(const Vec3& p, const Segment& segment);
double distance_sq(const Segment& a, const Segment& b);
double distance_sq(const Vec3& p, const Corners& triangle);
double distance_sq(const Segment& segment, const Corners& triangle);

}  // namespace weft::engine::verify
