#pragma once
/// A mesh that changes its shape by prescription: places of its vertices at given times.

#include <vector>

#include "weft/core/vec.h"

namespace weft::engine {

/// Between two keys vertices move in straight lines; before the first and after the last they stay.
class MeshSequence {
 public:
  struct Key {
    double time = 0;              // [s]
    std::vector<Vec3> positions;  // (num_vertices) [m]
  };

  /// Two keys, and how far between them.
  struct Blend {
    int from = 0, to = 0;
    double share = 0;  // of `to` [1]
  };

  /// Throws InputError if there is no key, if times do not increase strictly, or if keys differ in their
  /// number of vertices.
  explicit MeshSequence(std::vector<Key> keys);

  int num_vertices() const { return static_cast<int>(keys_[0].positions.size()); }
  const std::vector<Key>& keys() const { return keys_; }

  Blend at(double time) const;

  Vec3 position(const Blend& blend, int vertex) const {
    const Vec3& from = keys_[blend.from].positions[vertex];
    return from + blend.share * (keys_[blend.to].positions[vertex] - from);
  }

 private:
  std::vector<Key> keys_;
};

}  // namespace weft::engine
