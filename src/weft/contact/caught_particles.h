#pragma once
/// Cloth caught between colliders: in a gripper, under a hand on a table, in an armpit.
///
///        first ↓            Where two surfaces of colliders leave a particle less room than it is thick, no
///     ╲───────────╱         position satisfies both contacts: each would push cloth through the other, and
///      ╲─ middle ─╱         stretch it without end. Both are replaced by planes around the surface halfway
///     ╱───────────╲         between them. The cloth around is not pulled; when the colliders part, the
///        second ↑           particle is between them.

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "weft/contact/constraint.h"
#include "weft/core/vec.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

/// A caught particle in a step.
struct Caught {
  int vertex = 0;  // under the common numbering
  std::array<HoldingSide, 2> sides;

  /// normal · x >= target at the end of the step.
  struct Plane {
    Vec3 normal;    // unit length
    double target;  // [m]
    Vec3 velocity;  // of the side's surface [m/s]
  };
  std::array<std::optional<Plane>, 2> planes = {};  // of the sides; empty: the particle is free of that side
};

class CaughtParticles {
 public:
  /// For vertices 0 … num_cloth_vertices − 1 of cloth, then those of meshes, with their colliders' numbers.
  void reset(int num_cloth_vertices, std::vector<int> collider_of_body_vertex);

  void clear();

  /// In any order; vertices that are caught already are skipped.
  void add(const Caught& caught);

  bool empty() const { return all_.empty(); }
  std::span<const Caught> all() const { return all_; }
  bool has(int vertex) const { return !all_.empty() && number_[vertex] >= 0; }

  /// Whether one of a pair's vertices is caught by the collider on the pair's other side: a mesh with other
  /// vertices of the pair, or the primitive shape with this number, else -1.
  bool includes(std::span<const int> vertices, int shape) const;

  /// Whether the planes around a caught vertex replace this constraint.
  bool replaces(const Constraint& c) const {
    return includes(std::span(c.vertex).first(c.num_vertices), c.shape);
  }

 private:
  int num_cloth_vertices_ = 0;
  std::vector<int> collider_of_;  // (vertices of meshes)
  std::vector<int> number_;       // (cloth vertices) index into all_, -1: free
  std::vector<Caught> all_;
};

}  // namespace weft::engine
