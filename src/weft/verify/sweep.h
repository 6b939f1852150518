#pragma once
/// Private to verify/: pairs of triangles with overlapping boxes (sweep and prune).

#include <algorithm>
#include <array>
#include <vector>

#include "weft/verify/crossings.h"

namespace weft::engine::verify {

/// A sweep along the axis of greatest extent, in each of many strips along the second. Boxes are stored in
/// floats: rounding never changes the order of two numbers, so it hides no overlap. Nor do bounds of what
/// floats cannot hold.
class Sweep {
 public:
  struct Box {
    Box(const Eigen::Vector3f& from, const Eigen::Vector3f& to, TriangleId triangle)
        : low{bounded(from[0]), bounded(from[1]), bounded(from[2])},
          high{bounded(to[0]), bounded(to[1]), bounded(to[2])},
          id(triangle) {}

    static float bounded(float x) { return std::clamp(x, -1e30f, 1e30f); }

    std::array<float, 3> low, high;
    TriangleId id;
    int first_strip = 0;
  };

  explicit Sweep(std::vector<Box> boxes);

  /// Calls visit(p, q) once for every two triangles with overlapping boxes.
  template <class Visit>
  void for_each_pair(Visit visit) const {
    std::vector<int> hits(boxes_.size());
    for (int s = 0; s < static_cast<int>(strips_.size()); ++s) {
      const Strip& strip = strips_[s];
      for (std::size_t i = 0; i < strip.boxes.size(); ++i) {
        const int num_hits = strip.collect_overlaps(i, hits.data());
        const Box& box = boxes_[strip.boxes[i]];
        for (int h = 0; h < num_hits; ++h) {
          const Box& other = boxes_[strip.boxes[hits[h]]];
          const bool is_first_in_common = std::max(box.first_strip, other.first_strip) == s;
          if (is_first_in_common) visit(box.id, other.id);
        }
      }
    }
  }

 private:
  /// Boxes of one strip in sweep order, as columns.
  struct Strip {
    std::vector<int> boxes;
    std::vector<float> start, end, low_y, high_y, low_z, high_z;

    /// Indices of boxes after box i that overlap it; returns their number.
    int collect_overlaps(std::size_t i, int* hits) const;
  };

  void choose_axes();
  void fill_strips();
  void add_to_strip(int k, Strip& strip) const;

  std::vector<Box> boxes_;  // in sweep order
  int sweep_axis_ = 0, strip_axis_ = 1, third_axis_ = 2;
  std::vector<Strip> strips_;
};

}  // namespace weft::engine::verify
