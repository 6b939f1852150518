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
  const auto next = std::upper_bound(keys_.begin(), keys_.end(), time,
                                     [](double t, const Key& key) { return t < key.time; });
  const Key& from = next == keys_.begin() ? keys_.front() : *(next - 1);
  const Key& to = next == keys_.end() ? keys_.back() : *next;
  const double span = to.time - from.time, share = span > 0 ? (time - from.time) / span : 0.0;
  positions.resize(from.positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v)
    positions[v] = from.positions[v] + share * (to.positions[v] - from.positions[v]);
}

}  // namespace weft::engine
