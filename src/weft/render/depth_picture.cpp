#include "weft/render/depth_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "weft/core/angle.h"

namespace weft::engine {
namespace {

/// A triangle a b c seen from the origin, by rasterisation in homogeneous coordinates (Olano and Greer 1997).
/// The ray t d meets it with weights w, where
///
///     w_a = t d·(b × c) / D,  w_b = t d·(c × a) / D,  w_c = t d·(a × b) / D,   D = a·(b × c)
///
/// and Σ w = 1 gives t. No clipping is needed. Triangles at an edge have opposite products there, bit by bit:
/// no ray passes between them.
struct SeenTriangle {
  std::array<Vec3, 3> products;
  double determinant;

  SeenTriangle(const Vec3& a, const Vec3& b, const Vec3& c)
      : products{b.cross(c), c.cross(a), a.cross(b)}, determinant(a.dot(products[0])) {}

  /// The ray's t; infinity if it misses.
  double meet(const Vec3& d) const {
    double sum = 0;
    for (const Vec3& product : products) {
      const double share = d.dot(product);
      if (share * determinant < 0) return std::numeric_limits<double>::infinity();
      sum += share;
    }
    const double t = determinant / sum;
    return t > 0 ? t : std::numeric_limits<double>::infinity();
  }
};

/// Half-open ranges of pixels.
struct PixelBox {
  int left, right, top, bottom;
};

class DepthRaster {
 public:
  DepthRaster(const Camera& camera, PictureSize size)
      : size_(size),
        eye_(camera.eye()),
        axes_{camera.right(), -camera.up(), camera.forward()},
        pixel_(pixel_size(camera.fov_deg, size.height)) {
    const std::size_t count = static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
    picture_.depth.assign(count, std::numeric_limits<float>::infinity());
    picture_.index.assign(count, -1);
  }

  void draw(const DrawnMesh& mesh, int index) {
    std::vector<Vec3> seen;
    for (std::size_t i = 0; i + 2 < mesh.positions.size(); i += 3) {
      const Vec3 p = Eigen::Map<const Eigen::Vector3f>(&mesh.positions[i]).cast<double>() - eye_;
      seen.emplace_back(p.dot(axes_[0]), p.dot(axes_[1]), p.dot(axes_[2]));
    }
    for (const auto& [a, b, c] : mesh.triangles) {
      const SeenTriangle triangle(seen[a], seen[b], seen[c]);
      draw_pixels(box_around({seen[a], seen[b], seen[c]}), index,
                  [&](const Vec3& ray) { return triangle.meet(ray); });
    }
  }

  /// The plane y = height.
  void draw_ground(double height, int index) {
    const double rise = height - eye_.y();
    const Vec3 up(axes_[0].y(), axes_[1].y(), axes_[2].y());  // the world's, in the camera's axes
    draw_pixels({0, size_.width, 0, size_.height}, index, [&](const Vec3& ray) {
      const double t = rise / ray.dot(up);
      return t > 0 ? t : std::numeric_limits<double>::infinity();
    });
  }

  DepthPicture take() { return std::move(picture_); }

 private:
  /// Height of a pixel at distance 1 [1].
  static double pixel_size(double fov_deg, int height) {
    const SinCos half = sin_cos_deg(fov_deg / 2);
    return 2 * half.sin / half.cos / height;
  }

  /// The pixels whose centres a triangle may cover; all if it reaches behind the eye.
  PixelBox box_around(const std::array<Vec3, 3>& corners) const {
    double left = size_.width, right = 0, top = size_.height, bottom = 0;
    for (const Vec3& p : corners) {
      if (p.z() <= 1e-9) return {0, size_.width, 0, size_.height};
      const double x = p.x() / (p.z() * pixel_) + 0.5 * size_.width,
                   y = p.y() / (p.z() * pixel_) + 0.5 * size_.height;
      left = std::min(left, x - 1);  // a pixel of room for rounding
      right = std::max(right, x + 1);
      top = std::min(top, y - 1);
      bottom = std::max(bottom, y + 1);
    }
    return {static_cast<int>(std::max(left, 0.0)), static_cast<int>(std::min(right, 1.0 * size_.width)),
            static_cast<int>(std::max(top, 0.0)), static_cast<int>(std::min(bottom, 1.0 * size_.height))};
  }

  /// Keeps the depth where it is the least; of equal ones the first.
  template <class DepthAlong>
  void draw_pixels(const PixelBox& box, int index, const DepthAlong& depth_along) {
    for (int y = box.top; y < box.bottom; ++y) {
      for (int x = box.left; x < box.right; ++x) {
        const Vec3 ray((x + 0.5 - 0.5 * size_.width) * pixel_, (y + 0.5 - 0.5 * size_.height) * pixel_, 1);
        const float depth = static_cast<float>(depth_along(ray));
        const std::size_t pixel = static_cast<std::size_t>(y) * size_.width + x;
        if (!(depth < picture_.depth[pixel])) continue;
        picture_.depth[pixel] = depth;
        picture_.index[pixel] = index;
      }
    }
  }

  PictureSize size_;
  Vec3 eye_;
  std::array<Vec3, 3> axes_;  // right, down and forward in the picture, unit
  double pixel_;              // height of a pixel at distance 1 [1]
  DepthPicture picture_;
};

}  // namespace

DepthPicture draw_depths(std::span<const DrawnMesh> meshes, std::optional<double> ground,
                         const Camera& camera, PictureSize size) {
  DepthRaster raster(camera, size);
  for (std::size_t m = 0; m < meshes.size(); ++m) raster.draw(meshes[m], static_cast<int>(m));
  if (ground) raster.draw_ground(*ground, static_cast<int>(meshes.size()));
  return raster.take();
}

}  // namespace weft::engine
