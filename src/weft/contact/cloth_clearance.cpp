#include "weft/contact/cloth_clearance.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "weft/core/pack.h"
#include "weft/core/simd.h"

namespace weft::engine {
namespace {

constexpr int kCells = 4;       // along each side of a block
constexpr int kPatchCells = 2;  // along each side of a patch (patches.h)
constexpr int kFarthest = 3;    // blocks up to this far apart are tested by the rectangle around both

/// Rounding of float sums, relative to the measured size; and of a gradient of about 1 [1].
constexpr float kRounding = 2e-6f, kRoundingOfGradient = 1e-3f;

/// Limit of motion against itself, as a share of the cloth's size.
constexpr float kMaxRelativeMotion = 0.99f;

/// Per column, the minima of a quantity and of its negative over the rows of a block.
struct Minima {
  float *of, *of_opposite;
};

/// One component: cell sides, start positions, displacements.
struct Columns {
  Minima across, along, place, way;
};

WEFT_ALWAYS_INLINE void take_differences(const float* a, const float* b, int count, const Minima& least) {
  for (int i = 0; i < count; ++i) {
    const float difference = b[i] - a[i];
    least.of[i] = std::min(least.of[i], difference);
    least.of_opposite[i] = std::min(least.of_opposite[i], -difference);
  }
}

/// x and y: the component at the start and at the end, from the block's first particle row on.
WEFT_ALWAYS_INLINE void measure_columns_body(const float* x, const float* y, int columns, int cell_rows,
                                             const Columns& least) {
  for (int row = 0; row <= cell_rows; ++row, x += columns, y += columns) {
    for (const float* moment : {x, y}) {
      take_differences(moment, moment + 1, columns - 1, least.across);
      if (row < cell_rows) take_differences(moment, moment + columns, columns, least.along);
    }
    take_differences(x, y, columns, least.way);
    for (int i = 0; i < columns; ++i) {
      least.place.of[i] = std::min(least.place.of[i], x[i]);
      least.place.of_opposite[i] = std::min(least.place.of_opposite[i], -x[i]);
    }
  }
}
WEFT_MULTIVERSION(measure_columns,
                  (const float* x, const float* y, int columns, int cell_rows, const Columns& least),
                  (x, y, columns, cell_rows, least))

/// least[i] becomes the minimum of itself and the next kCells − 1.
WEFT_ALWAYS_INLINE void spread_body(float* least, int count) {
  static_assert(kCells == 4);
  for (const int shift : {1, 2}) {
    for (int i = 0; i < count; ++i) least[i] = std::min(least[i], least[i + shift]);
  }
}
WEFT_MULTIVERSION(spread, (float* least, int count), (least, count))

/// σ_min of the matrix with the columns a, b.
float find_least_stretch(const Float4& a, const Float4& b) {
  const float aa = a.squaredNorm(), bb = b.squaredNorm(), ab = a.dot(b), half = 0.5f * (aa - bb);
  return std::sqrt(std::max(0.0f, 0.5f * (aa + bb) - std::sqrt(half * half + ab * ab)));
}

int num_blocks(int count, int size) { return (count + size - 1) / size; }

}  // namespace

void ClothClearance::Block::merge(const Block& other) {
  box.merge(other.box);
  across_min = across_min.cwiseMin(other.across_min);
  across_max = across_max.cwiseMax(other.across_max);
  along_min = along_min.cwiseMin(other.along_min);
  along_max = along_max.cwiseMax(other.along_max);
}

ClothClearance::Level::Level(int cells_x, int cells_z, int cells)
    : columns(num_blocks(cells_x, cells)), rows(num_blocks(cells_z, cells)) {
  const Float4 zero = Float4::Zero();
  blocks.assign(static_cast<std::size_t>(columns) * rows, {{zero, zero, zero, zero}, zero, zero, zero, zero});
}

ClothClearance::Cloth::Cloth(const Grid& of, int number)
    : grid(of),
      patches(of.cells_x, of.cells_z, kPatchCells),
      is_measured(patches.blocks.size(), 0),
      first_patch(number) {
  int cells = kCells;
  do {
    levels.emplace_back(grid.cells_x, grid.cells_z, cells);
    cells *= 2;
  } while (levels.back().blocks.size() > 1);
}

int ClothClearance::Cloth::top() const { return static_cast<int>(levels.size()); }

/// Bounds of the rectangle around two blocks.
ClothClearance::Block ClothClearance::Cloth::around(int level, Place a, Place b) {
  const auto [left, right] = std::minmax(a.column, b.column);
  const auto [top_row, bottom] = std::minmax(a.row, b.row);
  Block all;
  for (int row = top_row; row <= bottom; ++row) {
    for (int column = left; column <= right; ++column)
      all.merge(level == 0 ? measure_patch(column, row) : levels[level - 1].at(column, row));
  }
  return all;
}

const ClothClearance::Block& ClothClearance::Cloth::measure_patch(int column, int row) {
  Block& patch = patches.at(column, row);
  char& is_known = is_measured[row * patches.columns + column];
  if (!is_known) {
    patch = measure_cells({column * kPatchCells, row * kPatchCells},
                          {std::min((column + 1) * kPatchCells, grid.cells_x),
                           std::min((row + 1) * kPatchCells, grid.cells_z)});
  }
  is_known = 1;
  return patch;
}

/// Bounds of the cells in [first, end_cell).
ClothClearance::Block ClothClearance::Cloth::measure_cells(Place first, Place end_cell) {
  const auto count = static_cast<std::size_t>(grid.num_particles());
  if (start.empty()) {
    for (const auto& [from, to] : {std::pair(motion.start, &start), std::pair(motion.end, &end)}) {
      for (std::size_t i = 0; i < count; ++i)
        to->emplace_back(from->x()[i], from->y()[i], from->z()[i], 0.0f);
    }
  }
  Block block;
  for (int row = first.row; row <= end_cell.row; ++row) {
    for (int column = first.column; column <= end_cell.column; ++column) {
      const int i = grid.index(column, row);
      for (const std::vector<Float4>* x : {&start, &end}) {
        if (column < end_cell.column) block.add_across((*x)[i + 1] - (*x)[i]);
        if (row < end_cell.row) block.add_along((*x)[i + grid.num_columns()] - (*x)[i]);
      }
      block.box.add(start[i] + shift, end[i] - start[i]);
    }
  }
  return block;
}

/// The swept box, inflated by half the gap.
SweptBox ClothClearance::Cloth::box(int level, Place place) {
  SweptBox result = around(level, place, place).box;
  const Float4 margin = Float4::Constant(0.5f * gap + rounding);
  result.min -= margin;
  result.max += margin;
  return result;
}

/// Whether visit(place) is true for all blocks of the next finer level inside a block.
template <class Visit>
bool ClothClearance::Cloth::all_quarters(int level, Place place, const Visit& visit) const {
  const Level& finer = level == 1 ? patches : levels[level - 2];
  for (int row = 2 * place.row; row < std::min(2 * place.row + 2, finer.rows); ++row) {
    for (int column = 2 * place.column; column < std::min(2 * place.column + 2, finer.columns); ++column) {
      if (!visit(Place{column, row})) return false;
    }
  }
  return true;
}

void ClothClearance::reset(std::span<const Grid> grids) {
  constexpr int kQuantities = 8;
  cloths_.clear();
  num_patches_ = 0;
  std::size_t widest = 0;
  for (const Grid& grid : grids) {
    cloths_.emplace_back(grid, num_patches_);
    num_patches_ += static_cast<int>(cloths_.back().patches.blocks.size());
    widest = std::max(widest, static_cast<std::size_t>(round_up_to_pack(grid.num_columns() + kCells)));
  }
  least_.resize(kQuantities * widest);
}

/// Measures one row of blocks.
void ClothClearance::measure_row(const ClothMotion& motion, int row, const Grid& grid, Level& level) {
  const int columns = grid.num_columns(), pitch = round_up_to_pack(columns + kCells),
            first = grid.index(0, row * kCells), cell_rows = std::min(kCells, grid.cells_z - row * kCells);
  float* const all = least_.data();
  const auto minima = [&](int n) { return Minima{all + 2 * n * pitch, all + (2 * n + 1) * pitch}; };
  const Columns least{minima(0), minima(1), minima(2), minima(3)};
  const Vec3Array &x = *motion.start, &y = *motion.end;
  const float *const starts[] = {x.x(), x.y(), x.z()}, *const ends[] = {y.x(), y.y(), y.z()};
  for (int k = 0; k < 3; ++k) {
    std::fill_n(all, 8 * pitch, Aabb::kInfinity);
    measure_columns(starts[k] + first, ends[k] + first, columns, cell_rows, least);
    for (int n = 0; n < 8; ++n) spread(all + n * pitch, columns);
    for (int column = 0; column < level.columns; ++column) {
      const int i = column * kCells;
      const auto put = [&](const Minima& m, int more, Float4& min, Float4& max) {
        min.set(k, std::min(m.of[i], m.of[i + more]));
        max.set(k, -std::min(m.of_opposite[i], m.of_opposite[i + more]));
      };
      Block& block = level.at(column, row);
      put(least.across, 0, block.across_min, block.across_max);
      put(least.along, 1, block.along_min, block.along_max);
      put(least.place, 1, block.box.min, block.box.max);
      put(least.way, 1, block.box.way_min, block.box.way_max);
    }
  }
}

void ClothClearance::measure(const ClothMotion& motion, const Vec3& origin, Cloth& cloth) {
  cloth.motion = motion;
  cloth.start.clear();
  cloth.end.clear();
  std::fill(cloth.is_measured.begin(), cloth.is_measured.end(), char{0});
  cloth.shift = to_float4(motion.origin - origin);
  Level& finest = cloth.levels[0];
  for (int row = 0; row < finest.rows; ++row) measure_row(motion, row, cloth.grid, finest);
  for (Block& block : finest.blocks) {
    block.box.min += cloth.shift;
    block.box.max += cloth.shift;
  }
  for (std::size_t l = 1; l < cloth.levels.size(); ++l) {
    Level &fine = cloth.levels[l - 1], &coarse = cloth.levels[l];
    for (int row = 0; row < fine.rows; ++row) {
      for (int column = 0; column < fine.columns; ++column) {
        Block& block = coarse.at(column / 2, row / 2);
        if (row % 2 == 0 && column % 2 == 0)
          block = fine.at(column, row);
        else
          block.merge(fine.at(column, row));
      }
    }
  }
  const SweptBox& box = cloth.all().box;
  const auto largest = [](const Float4& a, const Float4& b) {
    return a.cwiseAbs().cwiseMax(b.cwiseAbs()).maxCoeff();
  };
  cloth.rounding = kRounding * (largest(box.min, box.max) + largest(box.way_min, box.way_max) +
                                2 * largest(cloth.shift, cloth.shift));
}

/// Whether the rectangle around two blocks cannot meet itself.
bool ClothClearance::is_flat(Cloth& cloth, int level, Place a, Place b) {
  const Block all = cloth.around(level, a, b);
  const auto cell_x = static_cast<float>(cloth.grid.spacing_x()),
             cell_z = static_cast<float>(cloth.grid.spacing_z());
  const float scale_x = 0.5f / cell_x, scale_z = 0.5f / cell_z;
  const float deviation = std::sqrt((scale_x * (all.across_max - all.across_min)).squaredNorm() +
                                    (scale_z * (all.along_max - all.along_min)).squaredNorm()) +
                          8 * cloth.rounding * std::max(scale_x, scale_z) + kRoundingOfGradient;
  const float least_stretch = find_least_stretch(scale_x * (all.across_min + all.across_max),
                                                 scale_z * (all.along_min + all.along_max));
  return (least_stretch - deviation) * (cell_x * cell_z / std::sqrt(cell_x * cell_x + cell_z * cell_z)) > cloth.gap;
}

/// Returns false if there are too many pairs.
bool ClothClearance::add_pair(int a, int b) {
  pairs_->push_back({std::min(a, b), std::max(a, b)});
  return pairs_->size() <= most_;
}

/// Pairs within a block. All searches return false if there are too many pairs.
bool ClothClearance::search_block(Cloth& cloth, int level, Place place) {
  if (is_flat(cloth, level, place, place)) return true;
  if (level == 0) return add_pair(cloth.patch(place), cloth.patch(place));
  return cloth.all_quarters(level, place, [&](Place a) {
    return cloth.all_quarters(level, place, [&](Place b) {
      if (std::pair(b.row, b.column) < std::pair(a.row, a.column)) return true;
      return a.row == b.row && a.column == b.column ? search_block(cloth, level - 1, a)
                                                    : search_blocks(cloth, level - 1, a, b);
    });
  });
}

bool ClothClearance::search_blocks(Cloth& cloth, int level, Place a, Place b) {
  const int apart = std::max(std::abs(a.column - b.column), std::abs(a.row - b.row));
  if (apart > 1 && !cloth.box(level, a).may_meet(cloth.box(level, b))) return true;
  if (apart <= kFarthest && is_flat(cloth, level, a, b)) return true;
  if (level == 0) return add_pair(cloth.patch(a), cloth.patch(b));
  return cloth.all_quarters(level, a, [&](Place p) {
    return cloth.all_quarters(level, b, [&](Place q) { return search_blocks(cloth, level - 1, p, q); });
  });
}

bool ClothClearance::search_cloths(Cloth& first, int level, Place a, Cloth& second, int other_level,
                                   Place b) {
  if (!first.box(level, a).may_meet(second.box(other_level, b))) return true;
  if (level == 0 && other_level == 0) return add_pair(first.patch(a), second.patch(b));
  if (level >= other_level) {
    return first.all_quarters(
        level, a, [&](Place p) { return search_cloths(first, level - 1, p, second, other_level, b); });
  }
  return second.all_quarters(
      other_level, b, [&](Place q) { return search_cloths(first, level, a, second, other_level - 1, q); });
}

bool ClothClearance::find_uncertain(std::span<const ClothMotion> cloths, double room, std::size_t most,
                                    std::vector<ItemPair>& pairs) {
  pairs.clear();
  pairs_ = &pairs;
  most_ = most;
  bounds_ = {};
  SweptBox all;
  for (std::size_t c = 0; c < cloths.size(); ++c) {
    Cloth& cloth = cloths_[c];
    cloth.gap = static_cast<float>(room * cloths[c].thickness);
    measure(cloths[c], cloths[0].origin, cloth);
    bounds_.merge(cloth.box(cloth.top(), {0, 0}));
    all.merge(cloth.all().box);
  }
  if (!((all.way_max - all.way_min).norm() < kMaxRelativeMotion * (all.max - all.min).norm())) return false;
  for (std::size_t c = 0; c < cloths.size(); ++c) {
    Cloth& cloth = cloths_[c];
    if (!search_block(cloth, cloth.top(), {0, 0})) return false;
    for (std::size_t d = 0; d < c; ++d) {
      if (!search_cloths(cloth, cloth.top(), {0, 0}, cloths_[d], cloths_[d].top(), {0, 0})) return false;
    }
  }
  return true;
}

}  // namespace weft::engine
