#pragma once
/// Where a picture is taken from.

#include <vector>

#include "weft/core/vec.h"

namespace weft::engine {

using Mat4 = Eigen::Matrix4d;

/// Width and height of a picture [pixels].
struct PictureSize {
  int width = 1280, height = 720;

  double aspect() const { return static_cast<double>(width) / height; }
};

struct Ray {
  Vec3 origin, direction;  // unit direction [m, 1]
};

/// A perspective camera that looks at a point; Y is up.
///
///     eye o - - - - - > target        azimuth turns the eye about the vertical through the target,
///                                     elevation lifts it
struct Camera {
  Vec3 target = Vec3::Zero();  // [m]
  double distance = 3;         // from eye to target, > 0 [m]
  double azimuth_deg = 30;     // 0: the eye is on the +z side of the target; grows towards +x
  double elevation_deg = 20;   // in (−90, 90)
  double fov_deg = 32;         // vertical field of view, in (0, 180)

  Vec3 eye() const;
  Vec3 forward() const;  // from eye to target, unit
  Vec3 right() const;    // unit
  Vec3 up() const;       // of the picture, unit

  /// World to camera; the camera looks along −z.
  Mat4 view() const;

  /// Camera to clip space, as OpenGL has it. Depths near to far [m] become −1 to 1.
  static Mat4 projection(double fov_deg, double aspect, double near, double far);

  /// The ray through a pixel's place; (0, 0) is the upper left corner of the picture [pixels].
  Ray ray(double x, double y, PictureSize size) const;

  /// What the mouse does. Angles in degrees; `pan` moves the target by shares of the picture's height.
  void orbit(double azimuth_deg, double elevation_deg);
  void pan(double right_share, double up_share);
  void zoom(double factor);  // > 1: away
};

/// The camera turned as `like`, at the smallest distance from which all points are in the picture, with a
/// margin.
Camera frame_points(const Camera& like, const std::vector<Vec3>& points, double aspect);

}  // namespace weft::engine
