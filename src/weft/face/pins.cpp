#include "weft/face/pins.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "weft/face/convert.h"
#include "weft/face/world_impl.h"
#include "weft/world/world_input.h"

namespace weft {
namespace engine {

std::string who(const std::string& kind, const std::string& name) { return kind + " \"" + name + "\": "; }

void hold_soft_pins(World& world, ClothId cloth) {
  const int count = static_cast<int>(world.attachments(cloth).size());
  for (int g = 0; g < count; ++g)
    world.set_attachment_target(cloth, g,
                                world.state(cloth).position(world.attachments(cloth)[g].particles[0]));
}

}  // namespace engine

namespace {

using engine::to_engine;
using engine::who;
using Held = engine::World::Held;

/// Soft pin: a separate spring per particle; see Pin.
engine::Attachment make_soft_pin(const Pin& pin, int particle, const engine::Vec3& position) {
  return {.particles = {particle},
          .shares = {1.0},
          .offsets = {engine::Vec3::Zero()},
          .stiffness = *pin.stiffness,
          .damping = pin.damping,
          .target = position};
}

void check_pin(const Pin& pin, const std::string& owner) {
  if (pin.follow && !pin.motion.empty())
    throw InputError(owner + "a pin that follows a collider has no motion of its own");
  if (!pin.stiffness) return;
  if (!pin.motion.empty())
    throw InputError(owner + "a pin with stiffness does not support motion; set targets before each step");
  for (const double number : {*pin.stiffness, pin.damping}) {
    if (!std::isfinite(number) || number < 0)
      throw InputError(owner + "a pin's stiffness and damping must be 0 or more");
  }
}

/// Pinned particles in the order of the pins' lists.
std::vector<int> list_particles(const Held& held, const std::vector<char>& is_soft) {
  std::vector<int> firm, particles;
  for (const engine::Pin& pin : held.pins)
    firm.insert(firm.end(), pin.particles.begin(), pin.particles.end());
  std::size_t num_firm = 0, num_soft = 0;
  for (const char soft : is_soft)
    particles.push_back(soft ? held.attachments[num_soft++].particles[0] : firm[num_firm++]);
  return particles;
}

/// A pin without targets moves along its key frames; all of a cloth's firm pins do, or none.
void append(const Pin& pin, const std::string& owner, const engine::World& world,
            const engine::ClothState& state, Held& held, std::vector<char>& is_soft) {
  check_pin(pin, owner);
  const engine::PointGuide& targets = pin.stiffness ? held.attachment_guide : held.pin_guide;
  if (!targets.is_empty() && !(pin.motion.empty() && !pin.follow))
    throw InputError(owner + "its pins have targets, which a pin with a motion or a collider cannot join");
  const int follow = pin.follow ? world.index(*pin.follow) : -1;
  if (!pin.stiffness)
    held.pins.push_back({pin.particles, to_engine(pin.motion, owner), to_engine(pin.pivot), follow});
  std::vector<engine::Vec3> positions;
  for (const int i : pin.particles) {
    if (i < 0 || static_cast<std::size_t>(i) >= state.x.size())
      throw InputError(owner + "there is no particle " + std::to_string(i) + " to pin; it has " +
                       std::to_string(state.x.size()));
    positions.push_back(state.position(i));
  }
  std::vector<engine::SurfaceAnchor> anchors(positions.size());
  if (pin.follow) anchors = world.bind(follow, positions);
  for (std::size_t p = 0; p < positions.size(); ++p) {
    const engine::Vec3& position = positions[p];
    if (pin.stiffness) {
      held.attachments.push_back(make_soft_pin(pin, pin.particles[p], position));
      held.attachments.back().follow = follow;
      held.attachments.back().anchor = anchors[p];
    } else {
      held.anchors.push_back(position);
      held.on_surface.push_back(anchors[p]);
    }
    engine::PointGuide& guide = pin.stiffness ? held.attachment_guide : held.pin_guide;
    if (!guide.is_empty()) {
      guide.from.push_back(position);
      guide.to.push_back(position);
    }
    is_soft.push_back(pin.stiffness.has_value());
  }
}

/// Removes the n-th point of a list.
template <class List>
void erase_at(List& list, std::size_t n) {
  if (n < list.size()) list.erase(list.begin() + static_cast<std::ptrdiff_t>(n));
}

void erase_firm(Held& held, std::size_t n) {
  std::size_t first = 0;
  for (engine::Pin& pin : held.pins) {
    if (n - first < pin.particles.size()) {
      erase_at(pin.particles, n - first);
      break;
    }
    first += pin.particles.size();
  }
  std::erase_if(held.pins, [](const engine::Pin& pin) { return pin.particles.empty(); });
  erase_at(held.anchors, n);
  erase_at(held.on_surface, n);
  erase_at(held.pin_guide.from, n);
  erase_at(held.pin_guide.to, n);
}

void erase_soft(Held& held, std::size_t n) {
  erase_at(held.attachments, n);
  erase_at(held.attachment_guide.from, n);
  erase_at(held.attachment_guide.to, n);
}

void require_no_duplicates(std::vector<int> particles, const std::string& owner) {
  std::ranges::sort(particles);
  const auto twice = std::ranges::adjacent_find(particles);
  if (twice != particles.end())
    throw InputError(owner + "particle " + std::to_string(*twice) + " is pinned twice");
}

}  // namespace

void World::set_pins(ClothId cloth, const std::vector<Pin>& pins) {
  Impl::Cloth& own = impl_->at(cloth);
  Held held;
  held.forces = impl_->world.forces(cloth);
  std::vector<char> is_soft;
  for (const Pin& pin : pins)
    append(pin, who("cloth", own.desc.name), impl_->world, impl_->world.state(cloth), held, is_soft);
  require_no_duplicates(list_particles(held, is_soft), who("cloth", own.desc.name));
  impl_->world.hold(cloth, std::move(held));
  own.is_soft = std::move(is_soft);
}

void World::add_pin(ClothId cloth, const Pin& pin) {
  Impl::Cloth& own = impl_->at(cloth);
  Held held = impl_->world.held(cloth);
  std::vector<char> is_soft = own.is_soft;
  append(pin, who("cloth", own.desc.name), impl_->world, impl_->world.state(cloth), held, is_soft);
  require_no_duplicates(list_particles(held, is_soft), who("cloth", own.desc.name));
  impl_->world.hold(cloth, std::move(held));
  own.is_soft = std::move(is_soft);
}

void World::unpin(ClothId cloth, const std::vector<int>& particles) {
  Impl::Cloth& own = impl_->at(cloth);
  Held held = impl_->world.held(cloth);
  std::vector<char> is_soft = own.is_soft;
  for (const int i : particles) {
    const std::vector<int> pinned = list_particles(held, is_soft);
    const auto found = std::ranges::find(pinned, i);
    if (found == pinned.end())
      throw InputError(who("cloth", own.desc.name) + "particle " + std::to_string(i) + " is not pinned");
    const auto order = found - pinned.begin();
    const auto same = static_cast<std::size_t>(
        std::count(is_soft.begin(), is_soft.begin() + order, is_soft[static_cast<std::size_t>(order)]));
    is_soft[static_cast<std::size_t>(order)] ? erase_soft(held, same) : erase_firm(held, same);
    is_soft.erase(is_soft.begin() + order);
  }
  impl_->world.hold(cloth, std::move(held));
  own.is_soft = std::move(is_soft);
}

std::vector<int> World::pinned_particles(ClothId cloth) const {
  return list_particles(impl_->world.held(cloth), impl_->at(cloth).is_soft);
}

void World::move_pins(ClothId cloth, const std::vector<Vec3>& at_end) {
  const std::vector<char>& is_soft = impl_->at(cloth).is_soft;
  if (at_end.size() != is_soft.size())
    throw InputError(who("cloth", name(cloth)) + "expected targets for " + std::to_string(is_soft.size()) +
                     " pinned particles, got " + std::to_string(at_end.size()));
  std::vector<engine::Vec3> held, soft;
  for (std::size_t p = 0; p < at_end.size(); ++p) (is_soft[p] ? soft : held).push_back(to_engine(at_end[p]));
  for (const auto* targets : {&held, &soft})
    engine::require_finite(*targets, who("cloth", name(cloth)) + "targets of pins");
  if (!held.empty()) impl_->world.move_pins(cloth, held);
  if (!soft.empty()) impl_->world.move_attachments(cloth, soft);
}

void World::move_pins(ClothId cloth, const std::vector<int>& particles, const std::vector<Vec3>& at_end) {
  const std::string owner = who("cloth", name(cloth));
  if (particles.size() != at_end.size())
    throw InputError(owner + "expected a target for each of " + std::to_string(particles.size()) +
                     " particles, got " + std::to_string(at_end.size()));
  const Held held = impl_->world.held(cloth);
  const std::vector<char>& is_soft = impl_->at(cloth).is_soft;
  const std::vector<int> pinned = list_particles(held, is_soft);
  // The others keep the targets given for the next step, or stay.
  std::vector<Vec3> targets;
  std::size_t num_firm = 0, num_soft = 0;
  for (std::size_t p = 0; p < pinned.size(); ++p) {
    const engine::PointGuide& guide = is_soft[p] ? held.attachment_guide : held.pin_guide;
    const std::size_t n = is_soft[p] ? num_soft++ : num_firm++;
    const engine::Vec3 now = is_soft[p]
                                 ? held.attachments[n].target
                                 : impl_->world.state(cloth).position(static_cast<std::size_t>(pinned[p]));
    targets.push_back(engine::from_engine(!guide.is_empty() && guide.is_new ? guide.to[n] : now));
  }
  std::vector<int> order(static_cast<std::size_t>(num_particles(cloth)), -1);
  for (std::size_t p = 0; p < pinned.size(); ++p)
    order[static_cast<std::size_t>(pinned[p])] = static_cast<int>(p);
  for (std::size_t k = 0; k < particles.size(); ++k) {
    const int i = particles[k];
    const int p = i < 0 || i >= num_particles(cloth) ? -1 : order[static_cast<std::size_t>(i)];
    if (p < 0) throw InputError(owner + "particle " + std::to_string(i) + " is not pinned");
    targets[static_cast<std::size_t>(p)] = at_end[k];
  }
  move_pins(cloth, targets);
}

}  // namespace weft
