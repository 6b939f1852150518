#pragma once
/// A mesh with prescribed deformation: vertex positions at given times.

#include <vector>

#include "weft/animation/vertex_source.h"
#include "weft/core/vec.h"

namespace weft::engine {

/// Vertices move linearly between keys and are fixed before the first and after the last.
class MeshSequence final : public VertexSource {
 public:
  struct Key {
    double time = 0;              // [s]
    std::vector<Vec3> positions;  // (num_vertices) [m]
  };

  /// Throws InputError if there is no key, if times do not increase strictly, or if keys differ in their
  /// number of vertices.
  explicit MeshSequence(std::vector<Key> keys);

  int num_vertices() const override { return static_cast<int>(keys_[0].positions.size()); }
  bool is_still() const override { return keys_.size() == 1; }
  void evaluate(double time, std::vector<Vec3>& positions) const override;
  const std::vector<Key>& keys() const { return keys_; }

 private:
  std::vector<Key> keys_;
};

}  // namespace weft::engine
