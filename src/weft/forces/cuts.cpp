#include "weft/forces/cuts.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "weft/forces/membrane_patch.h"

namespace weft::engine {
namespace {

/// A triangle at a particle.
struct Wedge {
  int triangle = 0;
  std::array<int, 2> ends = {};  // of its edges at the particle
  Vec3 force = Vec3::Zero();     // on the particle [N]
};

/// The triangles around a particle.
struct OneRing {
  std::vector<Wedge> wedges;  // one beside the other: wedges[k] has spokes[k] and spokes[k + 1]
  std::vector<int> spokes;    // (num_wedges + 1) ends of edges; the first is the last of a closed one-ring

  bool is_closed() const { return spokes.front() == spokes.back(); }
};

/// The wedges in order; empty if they are not one sequence.
std::optional<OneRing> arrange(std::vector<Wedge> wedges) {
  const auto count = [&](int end) {
    return std::ranges::count_if(wedges,
                                 [&](const Wedge& w) { return w.ends[0] == end || w.ends[1] == end; });
  };
  int first = wedges[0].ends[0];
  for (const Wedge& w : wedges) {
    for (const int end : w.ends) {
      if (count(end) > 2) return std::nullopt;
      if (count(end) == 1) first = end;
    }
  }
  OneRing ring{{}, {first}};
  while (!wedges.empty()) {
    const int last = ring.spokes.back();
    const auto next =
        std::ranges::find_if(wedges, [&](const Wedge& w) { return w.ends[0] == last || w.ends[1] == last; });
    if (next == wedges.end()) return std::nullopt;
    ring.spokes.push_back(next->ends[0] == last ? next->ends[1] : next->ends[0]);
    ring.wedges.push_back(*next);
    wedges.erase(next);
  }
  return ring;
}

/// The forces of triangles on their corners (num_triangles) [N].
std::vector<TriangleCorners> find_triangle_forces(const ClothElements& elements, const std::vector<Vec3>& x) {
  std::vector<TriangleCorners> forces(elements.membranes.size());
  const PatchLaw law = elements.law();
  for (const MembranePatch& patch : elements.patches) {
    const auto own = patch_triangle_forces(patch, law, corners_of(patch, x));
    for (int t = 0; t < patch.num_triangles; ++t) forces[patch.triangles[t]] = own[t];
  }
  return forces;
}

class CutFinder {
 public:
  CutFinder(const ClothModel& model, const ClothState& state)
      : mesh_(model.topology->mesh),
        x_(to_doubles(state.x)),
        forces_(find_triangle_forces(*model.elements, x_)),
        bound_(x_.size(), 0.0) {
    std::vector<double> shortest(x_.size(), std::numeric_limits<double>::infinity());
    for (int t = 0; t < mesh_.num_triangles(); ++t) {
      const Triangle& corners = mesh_.triangles[t];
      for (int k = 0; k < 3; ++k) {
        bound_[corners[k]] += forces_[t][k].norm();
        for (const int other : {corners[(k + 1) % 3], corners[(k + 2) % 3]})
          shortest[corners[k]] = std::min(shortest[corners[k]], mesh_.between(t, corners[k], other).norm());
      }
    }
    for (std::size_t p = 0; p < bound_.size(); ++p) bound_[p] /= shortest[p];
  }

  /// An upper bound for the tension of cuts through a particle [N/m].
  double bound(int particle) const { return bound_[particle]; }

  /// The worst cut of each chosen particle; without ends: none.
  std::vector<Cut> find_worst(std::span<const char> is_chosen, std::span<const char> holds) const {
    std::vector<std::vector<Wedge>> wedges(x_.size());
    for (int t = 0; t < mesh_.num_triangles(); ++t) {
      const Triangle& corners = mesh_.triangles[t];
      for (int k = 0; k < 3; ++k) {
        if (is_chosen[corners[k]])
          wedges[corners[k]].push_back({t, {corners[(k + 1) % 3], corners[(k + 2) % 3]}, forces_[t][k]});
      }
    }
    std::vector<Cut> cuts(x_.size());
    for (int p = 0; std::cmp_less(p, x_.size()); ++p) {
      cuts[p].particle = p;
      if (wedges[p].empty()) continue;
      if (const std::optional<OneRing> ring = arrange(std::move(wedges[p])))
        find_worst(*ring, holds, cuts[p]);
    }
    return cuts;
  }

 private:
  void find_worst(const OneRing& ring, std::span<const char> holds, Cut& worst) const {
    const int count = static_cast<int>(ring.wedges.size());
    for (int begin = 0; begin < (ring.is_closed() ? count : 1); ++begin) {
      for (int end = begin + 1; end < count; ++end) {
        if (holds[ring.spokes[end]] || (ring.is_closed() && holds[ring.spokes[begin]])) continue;
        const double tension = find_tension(ring, worst.particle, begin, end);
        if (!(tension > worst.tension)) continue;
        worst.ends = {ring.spokes[end], ring.is_closed() ? ring.spokes[begin] : -1};
        worst.tension = tension;
      }
    }
  }

  /// Of the cut between the wedges from `begin` to `end` and the others.
  double find_tension(const OneRing& ring, int particle, int begin, int end) const {
    std::array<Vec3, 2> force = {Vec3::Zero(), Vec3::Zero()}, middle = force;  // of both sides
    std::array<int, 2> num_wedges = {0, 0};
    Vec3 facing = Vec3::Zero();
    for (int k = 0; std::cmp_less(k, ring.wedges.size()); ++k) {
      const int side = k >= begin && k < end ? 0 : 1;
      const auto& [a, b, c] = mesh_.triangles[ring.wedges[k].triangle];
      force[side] += ring.wedges[k].force;
      middle[side] += (x_[a] + x_[b] + x_[c]) / 3;
      facing += (x_[b] - x_[a]).cross(x_[c] - x_[a]);
      ++num_wedges[side];
    }
    const int from = ring.is_closed() ? ring.spokes[begin] : particle;
    Vec3 across = facing.cross(x_[ring.spokes[end]] - x_[from]).stableNormalized();
    if (across.dot(middle[0] / num_wedges[0] - middle[1] / num_wedges[1]) < 0) across = -across;
    double length = 0.5 * mesh_.between(ring.wedges[end].triangle, particle, ring.spokes[end]).norm();
    if (ring.is_closed())
      length += 0.5 * mesh_.between(ring.wedges[begin].triangle, particle, ring.spokes[begin]).norm();
    return 0.5 * across.dot(force[0] - force[1]) / length;
  }

  const RestMesh& mesh_;
  std::vector<Vec3> x_;                  // relative to the cloth's origin [m]
  std::vector<TriangleCorners> forces_;  // (num_triangles) [N]
  std::vector<double> bound_;            // (num_particles) [N/m]
};

}  // namespace

std::vector<Cut> find_cuts(const ClothModel& model, const ClothState& state, std::span<const char> holds,
                           double strength) {
  const CutFinder finder(model, state);
  std::vector<char> is_chosen(holds.size(), 0);
  bool is_any = false;
  for (std::size_t p = 0; p < holds.size(); ++p) {
    is_chosen[p] = !holds[p] && finder.bound(static_cast<int>(p)) > strength;
    is_any |= is_chosen[p] != 0;
  }
  std::vector<Cut> cuts;
  if (!is_any) return cuts;
  const std::vector<Cut> worst = finder.find_worst(is_chosen, holds);
  std::vector<char> is_exceeded(holds.size(), 0);  // by a neighbour
  for (const Triangle& t : model.topology->mesh.triangles) {
    for (const int a : t) {
      for (const int b : t) {
        if (worst[b].tension > worst[a].tension || (worst[b].tension == worst[a].tension && b < a))
          is_exceeded[a] = 1;
      }
    }
  }
  for (const Cut& cut : worst) {
    if (cut.tension > strength && !is_exceeded[cut.particle]) cuts.push_back(cut);
  }
  return cuts;
}

}  // namespace weft::engine
