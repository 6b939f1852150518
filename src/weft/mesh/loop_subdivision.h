#pragma once
/// Loop subdivision of triangle meshes, for drawing.

#include <span>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

/// Loop's scheme (C. Loop, Smooth subdivision surfaces based on triangles, 1987) as a sparse matrix, computed
/// once per mesh. Each level divides every triangle into four: the vertices stay the first ones, one on each
/// edge follows. Borders become cubic B-splines; edges of more than two triangles are borders too. A vertex on
/// more than two border edges stays.
class LoopSubdivision {
 public:
  /// `levels` >= 0; 0 is the mesh itself.
  LoopSubdivision(const std::vector<Triangle>& triangles, int num_vertices, int levels);

  const std::vector<Triangle>& triangles() const { return triangles_; }
  int num_vertices() const { return static_cast<int>(begins_.size()) - 1; }

  /// Values (num_vertices x width) of the fine mesh, from those of the mesh's vertices.
  std::vector<float> apply(std::span<const float> values, int width) const;

  /// The same, of a surface that nearly passes through the mesh's vertices, where Loop's lies inside round
  /// parts: control points are moved by the misses, twice (progressive interpolation, F. Cheng et al. 2009).
  std::vector<float> fit(std::span<const float> values, int width) const;

 private:
  struct Entry {
    int vertex;
    float weight;
  };

  void apply(std::span<const float> values, int width, std::span<float> result) const;

  std::vector<Triangle> triangles_;
  int num_coarse_;
  std::vector<int> begins_;     // (num_vertices + 1) of each row in entries_
  std::vector<Entry> entries_;  // weights of the mesh's vertices
};

}  // namespace weft::engine
