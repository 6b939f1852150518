#include "weft/integrators/free_pieces.h"

#include <algorithm>
#include <numeric>

namespace weft {

void FreePieces::find(const ClothModel& model, const std::vector<int>& pinned) {
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
  std::vector<int> number(n, 0);
  for (const int p : pinned) number[root(p)] = -1;
  int count = 0;
  for (int i = 0; i < n; ++i) {
    if (root(i) == i && number[i] == 0) number[i] = count++;
  }
  piece_.clear();
  moment_.resize(count);
  weight_.resize(count);
  is_held_.assign(count, 0);
  if (count == 0) return;
  for (int i = 0; i < n; ++i) piece_.push_back(number[root(i)]);
}

void FreePieces::hold(int particle) {
  if (!piece_.empty() && piece_[particle] >= 0) is_held_[piece_[particle]] = 1;
}

void FreePieces::release() { std::fill(is_held_.begin(), is_held_.end(), char{0}); }

void FreePieces::remove_mean(const PaddedRows& rows, const std::vector<float>& weight,
                             Vec3Array& displacement) {
  if (piece_.empty()) return;
  std::fill(moment_.begin(), moment_.end(), Vec3::Zero());
  std::fill(weight_.begin(), weight_.end(), 0.0);
  const int n = static_cast<int>(piece_.size());
  for (int i = 0; i < n; ++i) {
    if (piece_[i] < 0) continue;
    const int at = rows.index(i);
    weight_[piece_[i]] += weight[at];
    moment_[piece_[i]] += static_cast<double>(weight[at]) * displacement.get(at);
  }
  for (int i = 0; i < n; ++i) {
    if (piece_[i] < 0 || is_held_[piece_[i]]) continue;
    const int at = rows.index(i);
    displacement.set(at, displacement.get(at) - moment_[piece_[i]] / weight_[piece_[i]]);
  }
}

}  // namespace weft
