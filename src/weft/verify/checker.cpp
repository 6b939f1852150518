#include "weft/verify/checker.h"

#include <algorithm>
#include <map>

namespace weft::engine::verify {
namespace {

std::vector<SurfaceView> cloth_surfaces(const Frame& frame) {
  std::vector<SurfaceView> surfaces;
  for (const NamedCloth& cloth : frame.cloths) surfaces.push_back({cloth.positions, cloth.triangles, true});
  return surfaces;
}

/// Only mesh colliders have triangles.
void add_collider_surfaces(const Frame& frame, std::vector<SurfaceView>& surfaces) {
  for (const NamedCollider& collider : frame.colliders) {
    const auto* mesh = std::get_if<MeshView>(&collider.shape);
    surfaces.push_back(mesh ? SurfaceView{mesh->positions, mesh->triangles, false}
                            : SurfaceView{.positions = {}, .triangles = {}, .is_cloth = false});
  }
}

bool is_non_colliding(const Frame& frame, const std::string& a, const std::string& b) {
  return std::any_of(frame.non_colliding.begin(), frame.non_colliding.end(), [&](const auto& pair) {
    return (pair[0] == a && pair[1] == b) || (pair[0] == b && pair[1] == a);
  });
}

const std::string& bare_name_of(const Frame& frame, int surface) {
  const auto num_cloths = static_cast<int>(frame.cloths.size());
  return surface < num_cloths ? frame.cloths[surface].name : frame.colliders[surface - num_cloths].name;
}

/// The deepest penetration of each solid by the cloths that collide with it.
std::optional<Penetration> find_deepest_of_held(const Frame& frame, const std::vector<SurfaceView>& cloths,
                                                const std::vector<Solid>& solids) {
  if (frame.non_colliding.empty()) return find_deepest(cloths, solids);
  std::optional<Penetration> deepest;
  for (std::size_t s = 0; s < solids.size(); ++s) {
    std::vector<SurfaceView> held = cloths;
    for (std::size_t c = 0; c < held.size(); ++c) {
      if (is_non_colliding(frame, frame.cloths[c].name, frame.colliders[s].name))
        held[c] = {.positions = {}, .triangles = {}, .is_cloth = true};
    }
    std::optional<Penetration> found = find_deepest(held, {&solids[s], 1});
    if (found && found->solid >= 0) found->solid = static_cast<int>(s);
    if (found && (!deepest || found->depth > deepest->depth)) deepest = found;
  }
  return deepest;
}

std::string quoted(const std::string& kind, const std::string& name) { return kind + " \"" + name + "\""; }

std::string name_of(const Frame& frame, int surface) {
  const auto num_cloths = static_cast<int>(frame.cloths.size());
  if (surface < num_cloths) return quoted("cloth", frame.cloths[surface].name);
  return quoted("collider", frame.colliders[surface - num_cloths].name);
}

}  // namespace

FrameCheck check_frame(const Frame& frame, int num_listed) {
  FrameCheck check;
  std::vector<SurfaceView> surfaces = cloth_surfaces(frame);
  std::vector<Solid> solids;
  for (const NamedCollider& collider : frame.colliders) solids.push_back(collider.shape);
  check.deepest = find_deepest_of_held(frame, surfaces, solids);

  add_collider_surfaces(frame, surfaces);
  std::vector<Crossing> crossings = find_crossings(surfaces);
  std::erase_if(crossings, [&](const Crossing& c) {
    return is_non_colliding(frame, bare_name_of(frame, c.a.surface), bare_name_of(frame, c.b.surface));
  });
  check.intersections = static_cast<int>(crossings.size());
  const std::size_t listed = std::min(crossings.size(), static_cast<std::size_t>(num_listed));
  check.first.assign(crossings.begin(), crossings.begin() + static_cast<std::ptrdiff_t>(listed));
  return check;
}

std::string describe(const Frame& frame, const Crossing& crossing) {
  const auto& [a, b] = crossing;
  const std::string other = a.surface == b.surface ? "its" : name_of(frame, b.surface);
  return name_of(frame, a.surface) + " triangle " + std::to_string(a.triangle) + " intersects " + other +
         " triangle " + std::to_string(b.triangle);
}

std::vector<std::string> describe_by_surfaces(const Frame& frame, std::span<const Crossing> crossings) {
  std::map<std::pair<int, int>, std::pair<const Crossing*, int>> counts;  // the first, how many
  for (const Crossing& c : crossings)
    ++counts.try_emplace({c.a.surface, c.b.surface}, &c, 0).first->second.second;
  std::vector<std::string> messages;
  for (const auto& [surfaces, found] : counts) {
    messages.push_back(describe(frame, *found.first) + ", the first of " + std::to_string(found.second) +
                       (found.second == 1 ? " intersecting pair" : " intersecting pairs"));
  }
  return messages;
}

std::string describe(const Frame& frame, const Penetration& deepest) {
  if (deepest.solid < 0) return "nowhere";
  const std::string place = deepest.triangle >= 0 ? " triangle " + std::to_string(deepest.triangle)
                                                  : " particle " + std::to_string(deepest.particle);
  return quoted("cloth", frame.cloths[deepest.cloth].name) + place + " in " +
         quoted("collider", frame.colliders[deepest.solid].name);
}

}  // namespace weft::engine::verify
