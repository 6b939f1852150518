/// World::pin_forces: reactions of pins.

#include "weft/world/cloth_forces.h"
#include "weft/world/world.h"

namespace weft::engine {

std::vector<Vec3> World::pin_forces(ClothId id) const {
  const Cloth& cloth = at(id);
  std::vector<Vec3> reactions(cloth.pinned.size(), Vec3::Zero());
  if (last_step_ == 0 || reactions.empty()) return reactions;
  const int index = this->index(id);
  const ClothState before = split(id, before_step_.states[index]);
  const ClothModel& model = *cloth.model;
  std::vector<Vec3> force = compute_wind_forces(model, before, cloth.state, wind_, time_);
  const std::vector<Vec3> elastic = compute_elastic_forces(model, cloth.state),
                          damping = compute_damping_forces(model, cloth.state);
  for (const ContactPoint& contact : contact_points()) {
    if (contact.cloth == index) force[contact.particle] += contact.force;
    if (contact.other_cloth == index) force[contact.other_vertex] -= contact.force;
  }
  for (const PinnedParticle& p : cloth.pinned) {
    const int i = p.particle;
    const Vec3 acceleration = (cloth.state.v.get(i) - before.v.get(i)) / last_step_;
    reactions[p.order] = model.mass[i] * (acceleration - gravity_ - cloth.environment.external(i)) -
                         elastic[i] - damping[i] - force[i];
  }
  return reactions;
}

}  // namespace weft::engine
