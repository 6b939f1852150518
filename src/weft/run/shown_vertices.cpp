#include "weft/run/shown_vertices.h"

#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "weft/face/convert.h"
#include "weft/face/world_impl.h"
#include "weft/mesh/soup.h"

namespace weft::engine {
namespace {

class Builder {
 public:
  /// The given vertices, as yet without texture coordinates.
  Builder(const std::vector<int>& particles, const std::vector<Vec3>& positions, bool has_texture)
      : has_texture_(has_texture), is_free_(particles.size(), 1) {
    for (std::size_t v = 0; v < particles.size(); ++v) append(particles[v], positions[v]);
  }

  /// The vertex to show at a triangle's corner. `vertex`: the given one, -1: none.
  int find(int vertex, int particle, const Eigen::Vector2d& uv) {
    const Eigen::Vector2f own = (uv.allFinite() ? uv : Eigen::Vector2d(0, 0)).cast<float>();
    const auto [entry, is_new] = known_.try_emplace({vertex, particle, own.x(), own.y()});
    if (!is_new) return entry->second;
    if (vertex >= 0 && is_free_[vertex]) {
      is_free_[vertex] = 0;
      entry->second = vertex;
    } else {
      entry->second = append(particle, Vec3::Zero());
    }
    if (has_texture_) Eigen::Map<Eigen::Vector2f>(&shown_.texture[2 * entry->second]) = own;
    return entry->second;
  }

  void add(const Triangle& triangle) { shown_.triangles.push_back(triangle); }

  ShownVertices take() { return std::move(shown_); }

 private:
  int append(int particle, const Vec3& rest) {
    shown_.particles.push_back(particle);
    for (const double c : rest) shown_.rest.push_back(static_cast<float>(c));
    if (has_texture_) shown_.texture.resize(2 * shown_.particles.size());
    return static_cast<int>(shown_.particles.size()) - 1;
  }

  bool has_texture_;
  std::vector<char> is_free_;                                // (given vertices) not in a triangle so far
  std::map<std::tuple<int, int, float, float>, int> known_;  // by given vertex, particle, u and v
  ShownVertices shown_;
};

bool are_particles(const ShownVertices& shown, int num_particles) {
  std::vector<int> all(static_cast<std::size_t>(num_particles));
  std::iota(all.begin(), all.end(), 0);
  return shown.texture.empty() && shown.particles == all;
}

/// Of a triangle soup: its corners.
std::optional<ShownVertices> show_corners(const RestShape& rest) {
  if (rest.uv.empty()) return std::nullopt;
  ShownVertices shown{.particles = std::vector<int>(3 * rest.uv.size()),
                      .triangles = make_soup(static_cast<int>(rest.uv.size())),
                      .rest = std::vector<float>(9 * rest.uv.size(), 0.0f),
                      .texture = {}};
  std::iota(shown.particles.begin(), shown.particles.end(), 0);
  for (const CornerUv& corners : rest.uv) {
    for (const Eigen::Vector2d& uv : corners) {
      for (const double t : uv) shown.texture.push_back(std::isfinite(t) ? static_cast<float>(t) : 0.0f);
    }
  }
  return shown;
}

}  // namespace

std::optional<ShownVertices> show_vertices(const weft::World& world, ClothId cloth) {
  const RestShape& rest = WorldAccess::rest(world, cloth);
  if (WorldAccess::engine(world).can_tear(cloth)) return show_corners(rest);
  const std::vector<Triangle>& triangles = rest.topology->mesh.triangles;
  Builder builder(world.notes(cloth).particle_of_vertex, to_engine(world.vertex_positions(cloth)),
                  !rest.uv.empty());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    Triangle shown;
    for (int k = 0; k < 3; ++k) {
      const int particle = triangles[t][k];
      const int vertex = rest.vertices.empty() ? particle : rest.vertices[t][k];
      shown[k] = builder.find(vertex, particle, rest.uv.empty() ? Eigen::Vector2d::Zero() : rest.uv[t][k]);
    }
    builder.add(shown);
  }
  ShownVertices shown = builder.take();
  if (are_particles(shown, rest.topology->num_particles())) return std::nullopt;
  return shown;
}

}  // namespace weft::engine
