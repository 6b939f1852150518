#pragma once
/// Seams of a cloth's panels. Their energy and force: forces/seam_springs.h.

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "weft/mesh/rest_mesh.h"

namespace weft::engine {

/// A spring between a particle on one border and a point of an edge of another.
struct SeamSpring {
  std::array<int, 3> particles = {};  // the particle, and the ends of the edge
  double share = 0;                   // of the way from the first end to the second, in [0, 1] [1]
  double start = 0;                   // distance of the two points in the mesh [m]
  double stiffness = 0;               // [N/m]

  std::array<double, 3> weights() const { return {1, share - 1, -share}; }
};

struct Seams {
  std::vector<SeamSpring> springs;
  double time = 0;  // from the start distance to closed [s]
};

/// Springs from every vertex of two stretches of border to the point of the other at the same share of its length at rest.
/// Each has the stiffness of half of its length of seam, the seam's mean; `stiffness` is per length [N/m²].
std::vector<SeamSpring> make_seam_springs(const RestMesh& mesh, std::span<const int> a,
                                          std::span<const int> b, double stiffness);

/// Springs between pairs of particles. Each has the stiffness of its length of seam: the mean over both of the border's
/// edges around it, half of each, or of a mean edge within the cloth. `stiffness` is per length [N/m²]; empty: the
/// tension per strain `of_edges` [N/m] over the mean of those lengths. Particles paired with themselves have none.
std::vector<SeamSpring> make_stitches(const RestMesh& mesh, std::span<const std::array<int, 2>> pairs,
                                      std::optional<double> stiffness, double of_edges);

/// The mean length of the edges of stretches of border, at rest [m].
double mean_edge(const RestMesh& mesh, std::span<const int> a, std::span<const int> b);

}  // namespace weft::engine
