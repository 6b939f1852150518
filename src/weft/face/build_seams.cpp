#include "weft/face/build_seams.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "weft/error.h"
#include "weft/fabric/spring_warnings.h"
#include "weft/face/build_cloth.h"
#include "weft/mesh/border_path.h"

namespace weft::engine {
namespace {

/// The particles of vertices.
std::vector<int> find_particles(const std::vector<int>& vertices,
                                const std::vector<int>& particle_of_vertex) {
  std::vector<int> particles;
  for (const int v : vertices) {
    particles.push_back(find_particle(v, particle_of_vertex));
    if (particles.back() < 0)
      throw InputError("vertex " + std::to_string(v) + " was dropped with the triangles around it");
  }
  return particles;
}

/// Tension per strain of the cloth's edges, per length of border [N/m].
double edge_stiffness(const ClothDesc& desc) {
  const Fabric* fabric = std::get_if<Fabric>(&desc.fabric);
  return fabric ? (fabric->c11 + fabric->c22) / 2 : std::get<Springs>(desc.fabric).structural;
}

/// The springs between stretches of border.
void add_seams(const ClothDesc& desc, const RestMesh& mesh, const ClothNotes& notes, Seams& seams) {
  if (desc.seams.empty()) return;
  const BorderPaths paths(mesh);
  for (std::size_t s = 0; s < desc.seams.size(); ++s) {
    try {
      const auto find = [&](const std::vector<int>& vertices) {
        return paths.find(find_particles(vertices, notes.particle_of_vertex));
      };
      const std::vector<int> a = find(desc.seams[s].a), b = find(desc.seams[s].b);
      const double stiffness = desc.seam_stiffness.value_or(edge_stiffness(desc) / mean_edge(mesh, a, b));
      const std::vector<SeamSpring> springs = make_seam_springs(mesh, a, b, stiffness);
      if (springs.empty()) throw InputError("its two stretches of border are the same");
      seams.springs.insert(seams.springs.end(), springs.begin(), springs.end());
    } catch (const InputError& error) {
      throw InputError("seam " + std::to_string(s) + ": " + error.what());
    }
  }
}

}  // namespace

Seams build_seams(const ClothDesc& desc, const RestMesh& mesh, ClothNotes& notes) {
  Seams seams{.springs = {}, .time = desc.seam_time};
  add_seams(desc, mesh, notes, seams);
  std::vector<std::array<int, 2>> pairs;
  try {
    for (const auto& [a, b] : desc.stitches) {
      const std::vector<int> pair = find_particles({a, b}, notes.particle_of_vertex);
      pairs.push_back({pair[0], pair[1]});
    }
  } catch (const InputError& error) {
    throw InputError("stitch " + std::to_string(pairs.size()) + ": " + error.what());
  }
  const std::vector<SeamSpring> stitches =
      make_stitches(mesh, pairs, desc.seam_stiffness, edge_stiffness(desc));
  seams.springs.insert(seams.springs.end(), stitches.begin(), stitches.end());
  if (seams.springs.empty()) return seams;
  const double widest = std::ranges::max(seams.springs, {}, &SeamSpring::start).start;
  notes.done.push_back(std::to_string(desc.seams.size()) +
                       (desc.seams.size() == 1 ? " seam and " : " seams and ") +
                       std::to_string(stitches.size()) + (stitches.size() == 1 ? " stitch" : " stitches") +
                       " draw together, from up to " + short_text(widest) + " m");
  return seams;
}

}  // namespace weft::engine
