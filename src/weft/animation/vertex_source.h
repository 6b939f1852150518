#pragma once
/// Interface: vertices with a prescribed motion.

#include <vector>

#include "weft/core/vec.h"

namespace weft::engine {

/// Vertices as a function of time.
class VertexSource {
 public:
  virtual ~VertexSource() = default;

  virtual int num_vertices() const = 0;

  /// Whether no vertex moves at any time.
  virtual bool is_still() const = 0;

  /// Overwrites `positions` by the (num_vertices) positions at `time` [s], in metres. The result depends on
  /// the time only, and several threads may call it.
  virtual void evaluate(double time, std::vector<Vec3>& positions) const = 0;
};

}  // namespace weft::engine
