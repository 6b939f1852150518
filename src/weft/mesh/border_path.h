#pragma once
/// Stretches of a mesh's borders.

#include <memory>
#include <span>
#include <vector>

#include "weft/mesh/triangle_mesh.h"

namespace weft::engine {

struct Borders;

/// The borders of a mesh, which must outlive this.
class BorderPaths {
 public:
  explicit BorderPaths(const TriangleMesh& mesh);
  ~BorderPaths();

  /// The vertices of a border from the first of `stops` to the last, by way of the others in order, each time the
  /// shorter way. A closed border in full needs four stops, the last equal to the first. Throws InputError for fewer
  /// than two stops, stops that are not on one border or equal their successor, and two ways of equal length.
  std::vector<int> find(std::span<const int> stops) const;

 private:
  const TriangleMesh& mesh_;
  std::unique_ptr<const Borders> borders_;
};

}  // namespace weft::engine
