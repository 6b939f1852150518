#include "weft/contact/pair_settings.h"

#include <algorithm>
#include <cmath>

namespace weft::engine {

void PairTable::fill(std::span<const ContactCloth> cloths, std::span<const MovingShape> shapes,
                     std::span<const ContactRule> rules) {
  num_cloths_ = cloths.size();
  num_bodies_ = cloths.size() + shapes.size();
  settings_.clear();
  for (const ContactCloth& cloth : cloths) {
    const double own = cloth.model->material.friction;
    for (const ContactCloth& other : cloths)
      settings_.push_back({.friction = std::sqrt(own * other.model->material.friction)});
    for (const MovingShape& shape : shapes)
      settings_.push_back({shape.collider->friction, shape.collider->static_friction});
  }
  for (const ContactRule& rule : rules) {
    const BodyPlace cloth{.cloth = rule.cloth}, other{.cloth = rule.other_cloth, .collider = rule.collider};
    PairSettings& settings = settings_[index(cloth, other)];
    settings = {rule.friction.value_or(settings.friction),
                rule.static_friction.value_or(settings.static_friction), rule.collide};
    if (rule.other_cloth >= 0) settings_[index(other, cloth)] = settings;
  }
  fill_filter();
}

bool PairTable::has_static_friction() const {
  return std::any_of(settings_.begin(), settings_.end(),
                     [](const PairSettings& settings) { return settings.has_static_friction(); });
}

void PairTable::fill_filter() {
  non_colliding_.clear();
  if (std::all_of(settings_.begin(), settings_.end(),
                  [](const PairSettings& settings) { return settings.collide; }))
    return;
  non_colliding_.assign(num_bodies_ * num_bodies_, 0);
  for (std::size_t c = 0; c < num_cloths_; ++c) {
    for (std::size_t t = 0; t < num_bodies_; ++t)
      non_colliding_[c * num_bodies_ + t] = non_colliding_[t * num_bodies_ + c] =
          !settings_[c * num_bodies_ + t].collide;
  }
}

}  // namespace weft::engine
