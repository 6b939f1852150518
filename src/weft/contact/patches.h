#pragma once
/// Patches: small connected groups of triangles, and a criterion that excludes self contact within them.
///
///      o---o---o     A patch of a grid is 2×2 cells; of a mesh up to eight connected triangles.
///      | \ | / |     Patches that share a vertex are neighbours. A window is a group of neighbours:
///      o---o---o     on a grid four in a square, on a mesh one patch and all around it.
///      | / | \ |
///      o---o---o
///
/// Let M be a mean deformation gradient, and E the largest |F − M| of any triangle's gradient F in the
/// window. For points p, q of it, joined by a path of length at most C |p − q| on the surface at rest, the
/// mean value inequality says
///
///     |x(p) − x(q)|  >=  (σ_min(M) − C E) |p − q|
///
/// The right side, with the least rest distance D of two features without a common vertex, bounds how near
/// any two of them can come. On straight motions from start to end M(t) is the linear blend of both, so
/// σ_min² is at least the smaller of both less ¼ |M₁ − M₀|², and E at most the larger of both.

#include <span>
#include <vector>

#include "weft/contact/surface.h"
#include "weft/contact/swept_box.h"
#include "weft/core/job_system.h"
#include "weft/mesh/grid.h"

namespace weft::engine {

/// Deformation of a patch at one time.
struct PatchDeformation {
  Float4 x, y, z;              // M: images of the world axes at rest [1]
  float least_stretch_sq = 0;  // σ_min(M)² along the patch [1]
  float deviation = 0;         // the largest |F − M| of its triangles [1]
};

class Patches {
 public:
  static constexpr std::size_t kMaxTriangles = 8;  // of a patch

  /// Appends the patches of a grid cloth, whose mesh is build_grid_mesh(); of a mesh cloth with the rest
  /// positions `rest` (vertices of the surface, or more); or of a collider. All cloths come before all
  /// colliders. Requires the surface's one-rings.
  void add_grid(const Surface& surface, const Grid& grid, int first_vertex, int first_triangle);
  void add_mesh(const Surface& surface, const std::vector<Vec3>& rest, int first_triangle, int end_triangle,
                JobSystem& jobs);
  void add_body(const Surface& surface, int first_triangle, int end_triangle);

  int size() const { return static_cast<int>(triangle_begin_.size()) - 1; }
  int num_cloth() const { return num_cloth_; }  // cloth comes first, then colliders

  std::span<const int> triangles(int patch) const { return part_of(triangles_, triangle_begin_, patch); }
  std::span<const int> vertices(int patch) const { return part_of(vertices_, vertex_begin_, patch); }

  /// Two neighbours, or one patch with itself.
  struct Neighbours {
    int a = 0, b = 0;                      // a <= b
    int first_window = 0, end_window = 0;  // of window(n): each holds both
  };
  const std::vector<Neighbours>& neighbours() const { return neighbours_; }  // ascending
  int window(int n) const { return window_of_pair_[n]; }
  bool are_neighbours(int a, int b) const;  // or the same; a <= b

  /// Deformation of a cloth patch, with vertices at x (vertices) relative to any origin.
  PatchDeformation measure(int patch, const std::vector<Float4>& x) const;

  int num_windows() const { return static_cast<int>(windows_.size()); }
  std::span<const int> members(int window) const { return part_of(members_, member_begin_, window); }

  /// The least distance between two features of a window without a common vertex, at any time on the straight
  /// motion from `start` to `end` (cloth patches); 0 if none can be guaranteed. On meshes only for pairs that
  /// include the window's first patch [m].
  float least_distance(int window, const std::vector<PatchDeformation>& start,
                       const std::vector<PatchDeformation>& end) const;

 private:
  /// Vertices of a grid patch: first + row · stride + column.
  struct GridPart {
    int first = 0, stride = 0, columns = 0, rows = 0;  // cells
    float cell_x = 0, cell_z = 0;                      // [m]
  };

  /// The gradient of a mesh triangle: columns of e₁, e₂ = x_j − x_i, x_k − x_i by `inverse`, along two
  /// tangents of the triangle, which are rows of `tangents` in the patch's frame.
  struct TrianglePart {
    int i, j, k;
    float inverse[2][2];   // [1/m]
    float tangents[2][3];  // [1]
  };

  struct MeshPart {
    std::vector<TrianglePart> triangles;
    std::vector<std::array<float, 2>> weights;  // (vertices) of the least-squares gradient [1/m]
    Float4 frame[3];                            // two tangents and the normal at rest
  };

  struct Window {
    bool is_grid = false;      // M is the mean of all members, else the first one's
    float least_distance = 0;  // D; 0: no bound is known [m]
    float detour = 1;          // C of points nearer than `far` [1]
    float far = 0;             // … [m]
    float detour_of_far = 1;   // C of the others [1]
  };

  /// Index of a patch into grid_parts_ or mesh_parts_.
  struct Part {
    bool is_grid = false;
    int index = 0;
  };

  static std::span<const int> part_of(const std::vector<int>& all, const std::vector<int>& begin, int n) {
    return std::span(all).subspan(begin[n], begin[n + 1] - begin[n]);
  }
  void add_patch(const Surface& surface, std::span<const int> triangles);
  void group(const Surface& surface, int first_triangle, int end_triangle);
  void add_window(std::span<const int> members, const Window& window);
  std::vector<std::vector<int>> find_rings(int first_patch) const;
  void list_neighbours(int first_patch, int first_window);
  Window measure_rest(const Surface& surface, const std::vector<Vec3>& rest,
                      std::span<const int> members) const;
  PatchDeformation reference(int window, const std::vector<PatchDeformation>& at) const;
  MeshPart make_part(const Surface& surface, const std::vector<Vec3>& rest, int patch) const;
  PatchDeformation measure(const GridPart& part, const std::vector<Float4>& x) const;
  PatchDeformation measure(const MeshPart& part, std::span<const int> vertices,
                           const std::vector<Float4>& x) const;

  int num_cloth_ = 0;
  std::vector<int> triangle_begin_ = {0}, triangles_;
  std::vector<int> vertex_begin_ = {0}, vertices_;
  std::vector<Window> windows_;
  std::vector<int> member_begin_ = {0}, members_;
  std::vector<Neighbours> neighbours_;
  std::vector<int> first_neighbour_ = {0};  // (cloth patches + 1) of neighbours_, by a
  std::vector<int> window_of_pair_;
  std::vector<Part> parts_;  // (cloth patches)
  std::vector<GridPart> grid_parts_;
  std::vector<MeshPart> mesh_parts_;
};

}  // namespace weft::engine
