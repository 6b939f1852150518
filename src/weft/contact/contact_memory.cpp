#include "weft/contact/contact_memory.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace weft::engine {

void ContactMemory::begin_step(int num_particles) {
  last_.assign(num_particles, 0);
  lasting_.assign(num_particles, 0);
  sums_.assign(num_particles, {});
}

void ContactMemory::read(int first, const ClothState& state) {
  const MotionHistory& history = state.history;
  if (history.step == 0) return;
  std::ranges::copy(history.pressed.last, last_.begin() + first);
  std::ranges::copy(history.pressed.lasting, lasting_.begin() + first);
}

void ContactMemory::store(int first, ClothState& state) const {
  const auto num_particles = static_cast<int>(state.x.size());
  MotionHistory::Pressed& pressed = state.history.pressed;
  pressed.last.clear();
  pressed.lasting.clear();
  const auto begin = sums_.begin() + first;
  if (std::all_of(begin, begin + num_particles, [](const Sum& sum) { return sum.force == 0; })) return;
  for (int p = first; p < first + num_particles; ++p) {
    pressed.last.push_back(sums_[p].mean());
    pressed.lasting.push_back(std::min(sums_[p].mean(), last_[p]));
  }
}

void ContactMemory::restart() { std::ranges::fill(sums_, Sum{}); }

void ContactMemory::add(const Constraint& c, double force) {
  if (force == 0 || !is_of_cloths(c)) return;
  for (int k = 0; k < c.num_vertices; ++k) {
    Sum& sum = sums_[c.vertex[k]];
    sum.force += static_cast<float>(std::abs(c.weight[k]) * force);
    sum.weight += static_cast<float>(std::abs(c.weight[k]));
  }
}

bool ContactMemory::was_pressed(const Constraint& c) const {
  return last_[c.vertex[0]] > 0 && last_[c.vertex[3]] > 0;
}

double ContactMemory::lasting_force(const Constraint& c) const {
  if (!is_of_cloths(c)) return 0;
  double force = 0, weight = 0;
  for (int k = 0; k < c.num_vertices; ++k) {
    force += std::abs(c.weight[k]) * lasting_[c.vertex[k]];
    weight += std::abs(c.weight[k]);
  }
  return force / weight;
}

bool ContactMemory::is_of_cloths(const Constraint& c) const {
  return c.shape < 0 && std::cmp_less(std::max(c.vertex[0], c.vertex[3]), sums_.size());
}

}  // namespace weft::engine
