#include "weft/animation/mesh_sequence.h"

#include <algorithm>
#include <string>

#include "weft/error.h"

namespace weft::engine {

MeshSequence::MeshSequence(std::vector<Key> keys) : keys_(std::move(keys)) {
  if (keys_.empty()) throw InputError("a mesh sequence requires at least one key");
  for (std::size_t k = 1; k < keys_.size(); ++k) {
    const std::string key = "key " + std::to_string(k) + " of the mesh sequence ";
    if (!(keys_[k].time > keys_[k - 1].time)) throw InputError(key + "is not later than the previous one");
    if (keys_[k].positions.size() != keys_[0].positions.size())
      throw InputError(key + "has " + std::to_string(keys_[k].positions.size()) +
                       " vertices, the first key " + std::to_string(keys_[0].positions.size()) +
                       "; all must have the same number");
  }
}

void MeshSequence::evaluate(double time, std::vector<Vec3>& positions) const {
  const Blend blend = at(time);
  positions.resize(keys_[0].positions.size());
  for (int v = 0; v < num_vertices(); ++v) positions[v] = position(blend, v);
}

MeshSequence::Blend MeshSequence::at(double time) const {
  const auto next = std::upper_bound(keys_.begin(), keys_.end(), time,
                                     [](double t, const Key& key) { return t < key.time; });
  const int to = std::min<int>(static_cast<int>(next - keys_.begin()), static_cast<int>(keys_.size()) - 1);
  const int from = std::max(0, static_cast<int>(next - keys_.begin()) - 1);
  const double span = keys_[to].time - keys_[from].time;
  return {from, to, span > 0 ? (time - keys_[from].time) / span : 0.0};
}

}  // namespace weft::engine
