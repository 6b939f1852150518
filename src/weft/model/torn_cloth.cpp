#include "weft/model/torn_cloth.h"

#include <utility>

#include "weft/mesh/tear.h"

namespace weft::engine {
namespace {

template <class Values>
void split(std::span<const int> sources, std::vector<Values>& values) {
  if (values.empty()) return;
  std::vector<Values> result;
  result.reserve(sources.size());
  for (const int source : sources) result.push_back(values[source]);
  values = std::move(result);
}

void split(std::span<const int> sources, Vec3Array& values) {
  if (values.size() == 0) return;
  Vec3Array result(sources.size());
  for (std::size_t i = 0; i < sources.size(); ++i) result.set(i, values.get(sources[i]));
  values = std::move(result);
}

}  // namespace

std::shared_ptr<const ClothModel> build_torn_model(const TearingCloth& cloth, const ClothModel& present,
                                                   std::span<const int> broken) {
  RestMesh mesh = tear_mesh(cloth.whole->mesh, broken);
  auto elements = build_mesh_elements(mesh, cloth.warp, cloth.fabric);
  auto model = build_cloth_model(
      broken.empty() ? cloth.whole : build_mesh_topology(std::move(mesh), cloth.whole->seams),
      present.material, std::move(elements));
  return broken.empty() ? with_gas(*model, present.gas) : model;
}

ClothState split_particles(const ClothState& state, std::span<const int> sources, std::vector<int> broken) {
  ClothState result = state;
  for (Vec3Array* values : {&result.x, &result.v, &result.history.displacement, &result.history.velocity})
    split(sources, *values);
  for (auto* values : {&result.history.pressed.last, &result.history.pressed.lasting})
    split(sources, *values);
  PreciseState& precise = result.precise;
  for (auto* values : {&precise.x, &precise.v, &precise.displacement, &precise.velocity})
    split(sources, *values);
  result.torn = std::move(broken);
  return result;
}

}  // namespace weft::engine
