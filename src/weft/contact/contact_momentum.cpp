/// ContactSystem's account of what cloths that are solved for one after the other give each other.

#include <numeric>

#include "weft/contact/contact_system.h"

namespace weft {

void ContactSystem::find_pieces(const Surface& surface) {
  is_one_piece_.clear();
  std::vector<char> is_reached(surface.num_vertices, 0);
  std::vector<int> front;
  for (std::size_t c = 0; c + 1 < first_vertex_.size(); ++c) {
    const int begin = first_vertex_[c], end = first_vertex_[c + 1];
    int num_reached = 1;
    front.assign(1, begin);
    is_reached[begin] = 1;
    while (!front.empty()) {
      const int from = front.back();
      front.pop_back();
      for (const int t : surface.triangles_at(from)) {
        for (const int v : surface.triangles[t]) {
          if (is_reached[v]) continue;
          is_reached[v] = 1;
          ++num_reached;
          front.push_back(v);
        }
      }
    }
    is_one_piece_.push_back(num_reached == end - begin);
  }
}

void ContactSystem::begin_momentum() {
  const int num_cloths = static_cast<int>(cloths_.size());
  if (num_cloths < 2) return;
  touching_.resize(num_cloths);
  std::iota(touching_.begin(), touching_.end(), 0);
  is_held_.clear();
  momentum_before_.clear();
  for (int c = 0; c < num_cloths; ++c) {
    is_held_.push_back(!cloths_[c].is_free || !is_one_piece_[c]);
    momentum_before_.push_back(momentum_of(c));
  }
}

Vec3 ContactSystem::momentum_of(int cloth) const {
  const ClothModel& model = *cloths_[cloth].model;
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < model.num_particles(); ++i) sum += model.mass[i] * cloths_[cloth].state->v.get(i);
  return sum;
}

int ContactSystem::group_of(int cloth) const {
  while (touching_[cloth] != cloth) cloth = touching_[cloth];
  return cloth;
}

void ContactSystem::note_pushes(int cloth, std::span<const char> pushing) {
  if (cloths_.size() < 2) return;
  for (std::size_t n = 0; n < pushing.size(); ++n) {
    if (!pushing[n]) continue;
    const Constraint& c = constraints_[found_[n]];
    if (c.shape >= 0 || is_on_body(c)) {
      is_held_[cloth] = 1;
      continue;
    }
    for (const int v : {c.vertex[0], c.vertex[3]})
      touching_[group_of(mesh_of(first_vertex_, v))] = group_of(cloth);
  }
}

void ContactSystem::keep_momentum(const Vec3& gravity) {
  const int num_cloths = static_cast<int>(cloths_.size());
  if (num_cloths < 2) return;
  for (int group = 0; group < num_cloths; ++group) {
    int num_members = 0;
    bool is_held = false;
    double mass = 0;
    Vec3 lack = Vec3::Zero();
    for (int c = 0; c < num_cloths; ++c) {
      if (group_of(c) != group) continue;
      ++num_members;
      is_held |= is_held_[c] != 0;
      const std::vector<double>& masses = cloths_[c].model->mass;
      mass += std::accumulate(masses.begin(), masses.end(), 0.0);
      lack += momentum_before_[c] - momentum_of(c);
    }
    if (num_members < 2 || is_held) continue;
    const Vec3 change = lack / mass + step_.step * gravity;
    for (int c = 0; c < num_cloths; ++c) {
      if (group_of(c) == group) change_velocity(c, change);
    }
  }
}

void ContactSystem::change_velocity(int cloth, const Vec3& change) {
  ClothState& state = *cloths_[cloth].state;
  for (std::size_t i = 0; i < state.v.size(); ++i) {
    state.v.set(i, state.v.get(i) + change);
    state.x.set(i, state.x.get(i) + step_.step * change);
  }
  end_of(cloth);
}

}  // namespace weft
