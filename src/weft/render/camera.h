#pragma once
/// Camera of a picture.

#include <optional>
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

/// A perspective camera aimed at a point; Y is up.
///
///     eye o - - - - - > target        azimuth rotates the eye about the vertical through the target,
///                                     elevation raises it
struct Camera {
  Vec3 target = Vec3::Zero();  // [m]
  double distance = 3;         // from eye to target, > 0 [m]
  double azimuth_deg = 30;     // 0: the eye is on the +z side of the target; grows towards +x
  double elevation_deg = 20;   // in [−90, 90]
  double fov_deg = 32;         // vertical field of view, in (0, 180)

  Vec3 eye() const;
  Vec3 forward() const;  // from eye to target, unit
  Vec3 right() const;    // unit
  Vec3 up() const;       // of the picture, unit

  /// World to camera; the viewing direction is −z.
  Mat4 view() const;

  /// Camera to clip space, by OpenGL's convention. Depths near to far [m] become −1 to 1.
  static Mat4 projection(double fov_deg, double aspect, double near, double far);

  /// Ray through a position in pixels; (0, 0) is the upper left corner of the picture.
  Ray ray(double x, double y, PictureSize size) const;

  /// The position of a point in the picture [pixels]; empty: it is behind the eye.
  std::optional<Eigen::Vector2d> pixel(const Vec3& point, PictureSize size) const;

  /// Mouse control. Angles in degrees; `pan` moves the target by shares of the picture's height.
  void orbit(double azimuth_deg, double elevation_deg);
  void pan(double right_share, double up_share);
  void zoom(double factor);  // > 1: away
};

/// Finds the camera oriented as another, at the smallest distance at which all points are in the picture, with a
/// margin.
class CameraFit {
 public:
  CameraFit(const Camera& like, double aspect);

  void add(const Vec3& point);
  Camera camera() const;  // without points the one that it was given

 private:
  Camera like_;
  Vec3 x_axis_, y_axis_, z_axis_;  // of the camera: right, up, away from the eye
  double half_y_, half_x_;         // of the picture at distance 1, without its margin
  double left_ = -1e30, right_ = -1e30, below_ = -1e30, above_ = -1e30, depths_ = 0;
  std::size_t count_ = 0;
};

/// The same of these points.
Camera frame_points(const Camera& like, const std::vector<Vec3>& points, double aspect);

}  // namespace weft::engine
