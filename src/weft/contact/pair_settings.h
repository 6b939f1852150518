#pragma once
/// Friction of two bodies, and whether they collide: a cloth with a collider, another cloth or itself.

#include <optional>
#include <span>
#include <vector>

#include "weft/contact/moving_shape.h"
#include "weft/contact/numbering.h"

namespace weft::engine {

/// A user's settings for one pair of bodies.
struct ContactRule {
  int cloth = 0, other_cloth = -1, collider = -1;  // exactly one of the last two is not -1
  std::optional<double> friction;                  // Coulomb's coefficient; empty: from the bodies [1]
  std::optional<double> static_friction;           // of sticking contacts; empty: likewise [1]
  bool collide = true;                             // false: they do not collide
};

struct PairSettings {
  double friction = 0;         // [1]
  double static_friction = 0;  // of sticking contacts, if larger [1]
  bool collide = true;

  bool has_static_friction() const { return static_friction > friction; }
};

/// The settings of all pairs in a step.
class PairTable {
 public:
  /// Default friction: for two cloths the geometric mean of both, for a cloth and a collider the collider's. Of
  /// several rules for a pair the last one wins.
  void fill(std::span<const ContactCloth> cloths, std::span<const MovingShape> shapes,
            std::span<const ContactRule> rules);

  const PairSettings& of(const BodyPlace& cloth, const BodyPlace& other) const {
    return settings_[index(cloth, other)];
  }
  bool has_static_friction() const;

  /// Collision filter (bodies, bodies), 1: they do not collide; empty: all collide. Bodies are the cloths,
  /// followed by all colliders.
  const std::vector<char>& non_colliding() const { return non_colliding_; }

 private:
  void fill_filter();
  std::size_t index(const BodyPlace& cloth, const BodyPlace& other) const {
    return cloth.cloth * num_bodies_ + (other.cloth >= 0 ? other.cloth : num_cloths_ + other.collider);
  }

  std::size_t num_cloths_ = 0, num_bodies_ = 0;
  std::vector<PairSettings> settings_;  // (cloths, bodies)
  std::vector<char> non_colliding_;
};

}  // namespace weft::engine
