#include "weft/scene/pin_edits.h"

#include <algorithm>

namespace weft::engine {
namespace {

bool contains(std::span<const int> numbers, int number) {
  return std::ranges::find(numbers, number) != numbers.end();
}

/// The still pin of single vertices that the cloth has, or a new one.
ParticleIndices& own_pin(ClothSceneDesc& cloth) {
  for (PinDesc& pin : cloth.pins) {
    ParticleIndices* single = std::get_if<ParticleIndices>(&pin.select);
    if (single && pin.is_still()) return *single;
  }
  return cloth.pins.emplace_back().select.emplace<ParticleIndices>();
}

}  // namespace

void pin_vertices(std::span<const int> vertices, const PinnedVertices& pinned, ClothSceneDesc& cloth) {
  std::vector<int> added;
  for (const int vertex : vertices) {
    const auto has = [&](const std::vector<int>& pin) { return contains(pin, vertex); };
    if (std::ranges::none_of(pinned, has) && !contains(added, vertex)) added.push_back(vertex);
  }
  if (added.empty()) return;
  std::vector<int>& indices = own_pin(cloth).indices;
  indices.insert(indices.end(), added.begin(), added.end());
  std::ranges::sort(indices);
}

void unpin_vertices(std::span<const int> vertices, const PinnedVertices& pinned, ClothSceneDesc& cloth) {
  std::vector<PinDesc> kept;
  for (std::size_t k = 0; k < cloth.pins.size(); ++k) {
    ParticleIndices rest{pinned[k]};
    std::erase_if(rest.indices, [&](int vertex) { return contains(vertices, vertex); });
    if (rest.indices.empty()) continue;
    if (rest.indices.size() < pinned[k].size()) cloth.pins[k].select = std::move(rest);
    kept.push_back(std::move(cloth.pins[k]));
  }
  cloth.pins = std::move(kept);
}

}  // namespace weft::engine
