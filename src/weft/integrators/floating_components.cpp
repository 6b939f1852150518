#include "weft/integrators/floating_components.h"

#include <algorithm>
#include <numeric>

namespace weft::engine {

void FloatingComponents::find(const ClothModel& model, const std::vector<int>& pinned) {
  const int n = model.num_particles();
  std::vector<int> parent(n);
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  const std::vector<Spring>& springs = model.topology->springs;
  for (std::size_t s = 0; s < springs.size(); ++s) {
    if (model.stiffness(static_cast<int>(s)) > 0) parent[root(springs[s].i)] = root(springs[s].j);
  }
  if (model.elements) {
    for (const MembraneElement& m : model.elements->membranes) {
      for (const int c : {1, 2}) parent[root(m.vertices[0])] = root(m.vertices[c]);
    }
  }
  for (const SeamSpring& seam : model.topology->seams.springs) {
    for (const int k : {1, 2}) parent[root(seam.particles[0])] = root(seam.particles[k]);
  }
  std::vector<int> number(n, 0);
  for (const int p : pinned) number[root(p)] = -1;
  int count = 0;
  for (int i = 0; i < n; ++i) {
    if (root(i) == i && number[i] == 0) number[i] = count++;
  }
  count_ = count;
  component_.clear();
  if (count == 0) return;
  for (int i = 0; i < n; ++i) component_.push_back(number[root(i)]);
}

void FreeBodies::begin(std::span<const Member> members) {
  members_.assign(members.begin(), members.end());
  first_component_.assign(1, 0);
  for (const Member& m : members_) first_component_.push_back(first_component_.back() + m.components->size());
  release();
}

void FreeBodies::release() {
  parent_.resize(first_component_.back());
  std::iota(parent_.begin(), parent_.end(), 0);
  is_held_.assign(parent_.size(), 0);
  for (std::size_t m = 0; m < members_.size(); ++m) {
    if (members_[m].is_held)
      std::fill(is_held_.begin() + first_component_[m], is_held_.begin() + first_component_[m + 1], char{1});
  }
}

int FreeBodies::root_of(int component) const {
  while (parent_[component] != component) component = parent_[component];
  return component;
}

int FreeBodies::component_of(const Place& place) const {
  const int component = members_[place.member].components->component_of(place.particle);
  return component < 0 ? -1 : root_of(first_component_[place.member] + component);
}

void FreeBodies::touch(std::span<const Place> places, bool is_mutual) {
  int joined = -1;
  bool is_held = !is_mutual;
  for (const Place& place : places) {
    const int component = component_of(place);
    is_held |= component < 0 || is_held_[component];
    if (component < 0 || component == joined) continue;
    if (joined < 0) {
      joined = component;
      continue;
    }
    parent_[std::max(joined, component)] = std::min(joined, component);
    joined = std::min(joined, component);
  }
  if (joined >= 0 && is_held) is_held_[joined] = 1;
}

void FreeBodies::remove_mean(std::span<Vec3Array* const> displacements) {
  if (parent_.empty()) return;
  moment_.assign(parent_.size(), Vec3::Zero());
  weight_.assign(parent_.size(), 0.0);
  for (int& p : parent_) p = root_of(p);
  const auto for_free = [&](const auto& body) {
    for (std::size_t m = 0; m < members_.size(); ++m) {
      const auto& [components, rows, weight, is_held] = members_[m];
      if (components->size() == 0) continue;
      for (int i = 0; i < rows->num_particles(); ++i) {
        const int component = components->component_of(i);
        if (component < 0) continue;
        const int root = parent_[first_component_[m] + component], at = rows->index(i);
        if (!is_held_[root]) body(root, (*weight)[at], at, *displacements[m]);
      }
    }
  };
  for_free([&](int root, float weight, int at, const Vec3Array& displacement) {
    weight_[root] += weight;
    moment_[root] += static_cast<double>(weight) * displacement.get(at);
  });
  for_free([&](int root, float, int at, Vec3Array& displacement) {
    displacement.set(at, displacement.get(at) - moment_[root] / weight_[root]);
  });
}

}  // namespace weft::engine
