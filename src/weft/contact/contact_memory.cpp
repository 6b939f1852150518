#include "weft/contact/contact_memory.h"

#include <algorithm>
#include <cmath>

namespace weft::engine {

void ContactMemory::begin_step(int num_particles) {
  for (const int kind : {kByCloth, kByColliders}) {
    last_[kind].assign(num_particles, 0);
    lasting_[kind].assign(num_particles, 0);
    sums_[kind].assign(num_particles, {});
  }
}

void ContactMemory::read(int first, const ClothState& state) {
  const MotionHistory& history = state.history;
  if (history.step == 0) return;
  for (const int kind : {kByCloth, kByColliders}) {
    std::ranges::copy(history.pressed[kind].last, last_[kind].begin() + first);
    std::ranges::copy(history.pressed[kind].lasting, lasting_[kind].begin() + first);
  }
}

void ContactMemory::store(int first, ClothState& state) const {
  const auto num_particles = static_cast<int>(state.x.size());
  for (const int kind : {kByCloth, kByColliders}) {
    MotionHistory::Pressed& pressed = state.history.pressed[kind];
    pressed.last.clear();
    pressed.lasting.clear();
    const auto begin = sums_[kind].begin() + first;
    if (std::all_of(begin, begin + num_particles, [](const Sum& sum) { return sum.force == 0; })) continue;
    for (int p = first; p < first + num_particles; ++p) {
      pressed.last.push_back(sums_[kind][p].mean());
      pressed.lasting.push_back(std::min(sums_[kind][p].mean(), last_[kind][p]));
    }
  }
}

void ContactMemory::restart() {
  for (std::vector<Sum>& sums : sums_) std::ranges::fill(sums, Sum{});
}

void ContactMemory::add(const Constraint& c, double force) {
  if (force == 0 || c.is_caught) return;
  std::vector<Sum>& sums = sums_[kind_of(c)];
  for (int k = 0; k < c.num_vertices; ++k) {
    if (c.vertex[k] >= size()) continue;
    Sum& sum = sums[c.vertex[k]];
    sum.force += static_cast<float>(std::abs(c.weight[k]) * force);
    sum.weight += static_cast<float>(std::abs(c.weight[k]));
  }
}

bool ContactMemory::was_pressed(const Constraint& c) const {
  return last_[kByCloth][c.vertex[0]] > 0 && last_[kByCloth][c.vertex[3]] > 0;
}

double ContactMemory::lasting_force(const Constraint& c) const {
  if (c.is_caught) return 0;
  const std::vector<float>& lasting = lasting_[kind_of(c)];
  double force = 0, weight = 0;
  for (int k = 0; k < c.num_vertices; ++k) {
    if (c.vertex[k] >= size()) continue;
    force += std::abs(c.weight[k]) * lasting[c.vertex[k]];
    weight += std::abs(c.weight[k]);
  }
  return force / weight;
}

int ContactMemory::kind_of(const Constraint& c) const {
  return c.shape >= 0 || std::max(c.vertex[0], c.vertex[3]) >= size() ? kByColliders : kByCloth;
}

}  // namespace weft::engine
