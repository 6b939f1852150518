#pragma once
/// Conservative self-contact culling for grid cloth: one pass over the particles finds the patches that may
/// meet in a step. All others provably stay apart.
///
///     o--o--o--o--o     A block is 4×4 cells, and blocks form a quadtree. The cell sides along x, and those
///     |  |  |  |  |     along z, are bounded at the start and at the end of the step. These bounds limit the
///     o--o--o--o--o     deformation gradient F of every triangle at every time of straight motions: its
///                       columns are two sides of its cell over the cell size.
///
/// Let M be the centre of these bounds and E half of their diagonal. For points p, q of a rectangle of
/// blocks, the mean value inequality says at every time
///
///     |x(p) − x(q)|  >=  (σ_min(M) − E) |p − q|
///
/// With the least rest distance of two features without a common vertex, this bounds how near any two of
/// them come (compare patches.h). Two blocks stay apart if this holds in the rectangle around both, or if
/// their swept boxes are disjoint; otherwise their quarters are tested, down to the patches of 2×2 cells.

#include <span>
#include <vector>

#include "weft/contact/swept_box.h"
#include "weft/core/aligned.h"
#include "weft/core/vec3_array.h"
#include "weft/geometry/aabb_tree.h"
#include "weft/mesh/grid.h"

namespace weft::engine {

/// The motion of one cloth in a step: particle offsets from `origin`.
struct ClothMotion {
  const Vec3Array* start = nullptr;
  const Vec3Array* end = nullptr;
  Vec3 origin = Vec3::Zero();  // [m]
  double thickness = 0;        // [m]
};

class ClothClearance {
 public:
  void reset(std::span<const Grid> grids);

  /// Finds the pairs of patches, each once, whose features without a common vertex may come nearer than
  /// `room` times their thickness at any time. Patches are numbered as in Patches, a <= b. Returns false if
  /// there are more than `most`, or if cloth may move against itself by more than its size; then `pairs` is
  /// incomplete.
  bool find_uncertain(std::span<const ClothMotion> cloths, double room, std::size_t most,
                      std::vector<ItemPair>& pairs);

  int num_patches() const { return num_patches_; }

  /// Bounds of the last call: around all cloths, relative to the origin of the first one.
  const SweptBox& bounds() const { return bounds_; }

 private:
  struct Block {
    SweptBox box;                                       // from the first cloth's origin
    Float4 across_min = box.min, across_max = box.max;  // sides along the grid's x [m]
    Float4 along_min = box.min, along_max = box.max;    // and along its z [m]

    void add_across(const Float4& side) {
      across_min = across_min.cwiseMin(side);
      across_max = across_max.cwiseMax(side);
    }
    void add_along(const Float4& side) {
      along_min = along_min.cwiseMin(side);
      along_max = along_max.cwiseMax(side);
    }
    void merge(const Block& other);
  };

  /// A column and a row of blocks.
  struct Place {
    int column, row;
  };

  struct Level {
    int columns = 0, rows = 0;
    std::vector<Block> blocks;

    Level(int cells_x, int cells_z, int cells);
    Block& at(int column, int row) { return blocks[row * columns + column]; }
    const Block& at(int column, int row) const { return blocks[row * columns + column]; }
  };

  struct Cloth {
    Grid grid;
    ClothMotion motion;
    Float4 shift = Float4::Zero();   // from the first cloth's origin [m]
    float gap = 0;                   // minimum distance between two features [m]
    float rounding = 0;              // rounding error of positions [m]
    std::vector<Level> levels;       // blocks of 4×4 cells to a single block
    Level patches;                   // filled by measure_patch(), valid where is_measured
    std::vector<char> is_measured;   // (patches)
    int first_patch = 0;             // number
    std::vector<Float4> start, end;  // (particles) positions, if any patch is measured [m]

    Cloth(const Grid& of, int number);
    int top() const;  // the level of the single block; level 0 are patches
    int patch(Place place) const { return first_patch + place.row * patches.columns + place.column; }
    const Block& all() const { return levels.back().blocks[0]; }
    Block around(int level, Place a, Place b);
    const Block& measure_patch(int column, int row);
    Block measure_cells(Place first, Place end_cell);
    SweptBox box(int level, Place place);
    template <class Visit>
    bool all_quarters(int level, Place place, const Visit& visit) const;
  };

  void measure(const ClothMotion& motion, const Vec3& origin, Cloth& cloth);
  void measure_row(const ClothMotion& motion, int row, const Grid& grid, Level& level);
  static bool is_flat(Cloth& cloth, int level, Place a, Place b);
  bool add_pair(int a, int b);
  bool search_block(Cloth& cloth, int level, Place place);
  bool search_blocks(Cloth& cloth, int level, Place a, Place b);
  bool search_cloths(Cloth& first, int level, Place a, Cloth& second, int other_level, Place b);

  std::vector<Cloth> cloths_;
  int num_patches_ = 0;
  SweptBox bounds_;
  std::size_t most_ = 0;
  std::vector<ItemPair>* pairs_ = nullptr;
  AlignedFloats least_;  // work space of measure_row
};

}  // namespace weft::engine
