#include "weft/contact/caught_particles.h"

#include <algorithm>
#include <utility>

namespace weft::engine {

void CaughtParticles::reset(int num_cloth_vertices, std::vector<int> collider_of_body_vertex) {
  num_cloth_vertices_ = num_cloth_vertices;
  collider_of_ = std::move(collider_of_body_vertex);
  all_.clear();
  number_.assign(num_cloth_vertices, -1);
}

void CaughtParticles::clear() {
  for (const Caught& caught : all_) number_[caught.vertex] = -1;
  all_.clear();
}

void CaughtParticles::add(const Caught& caught) {
  if (number_[caught.vertex] >= 0) return;
  number_[caught.vertex] = static_cast<int>(all_.size());
  all_.push_back(caught);
}

bool CaughtParticles::includes(std::span<const int> vertices, int shape) const {
  if (all_.empty()) return false;
  int collider = shape;
  for (const int v : vertices) {
    if (v >= num_cloth_vertices_) collider = collider_of_[v - num_cloth_vertices_];
  }
  return std::any_of(vertices.begin(), vertices.end(), [&](int v) {
    if (v >= num_cloth_vertices_ || number_[v] < 0) return false;
    const auto& [first, second] = all_[number_[v]].sides;
    return first.collider == collider || second.collider == collider;
  });
}

}  // namespace weft::engine
