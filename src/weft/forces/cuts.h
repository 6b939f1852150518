#pragma once
/// Where cloth tears: cuts through a particle that carry more than the strength of the fabric.
///
///        a          A cut follows two edges of an inner particle p, or one at a border. It has triangles on two
///     \  ‖  /       sides, A and B. In balance their forces on p are opposite, and
///      \ ‖ /
///   A   \‖/   B     T = n·(F_A − F_B)/2 / (half the length of the cut's edges at rest)
///   ─────p─────
///       /‖\        is the tension across the cut, n in the cloth, normal to a–b. Uniform tension is exact,
///      / ‖ \       at borders too. At the end of a tear it rises with 1/√(edge length), as stress there does.
///        b
///
/// The criterion is of forces on vertices, as that of J. F. O'Brien and J. K. Hodgins, Graphical Modeling and Animation of
/// Brittle Fracture, SIGGRAPH 1999. Their cuts divide elements; these follow the edges of the mesh.

#include <array>
#include <span>
#include <vector>

#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

struct Cut {
  int particle = 0;
  std::array<int, 2> ends = {-1, -1};  // other ends of its edges; the second is −1 at a border
  double tension = 0;                  // [N/m]
};

/// The cuts with more tension than `strength` [N/m], of each particle the worst, if none of its neighbours has a worse
/// one. Particles that hold (num_particles) have none and end none. Nor have those whose triangles are not one sequence,
/// each beside the next. Only the forces of membranes count, without damping. The cloth has membranes.
std::vector<Cut> find_cuts(const ClothModel& model, const ClothState& state, std::span<const char> holds,
                           double strength);

}  // namespace weft::engine
