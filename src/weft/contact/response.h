#pragma once
/// What happens where a particle has come too close to a collider.

#include <vector>

#include "weft/contact/collider.h"
#include "weft/core/job_system.h"
#include "weft/model/cloth_state.h"

namespace weft {

/// A particle that a step may press against a collider: during the step the collider's surface is this plane.
///
///                 o particle
///     ------------------------- n·x = offset     x relative to the cloth's origin, `gap` above the collider
///     / / / / / / collider / / /
///
/// Integrators that solve for positions push back with the force stiffness · (offset − n·x) where that is
/// positive, and with up to `friction` times that force against sliding away from `grip`.
struct Contact {
  int particle = 0;
  Vec3 normal = Vec3::UnitY();  // unit length
  double offset = 0;            // [m]
  double stiffness = 0;         // [N/m]
  double friction = 0;          // Coulomb's coefficient [1]
  Vec3 grip = Vec3::Zero();     // where the collider's motion would take the particle if it stuck [m]
};

/// One step of contact between a cloth and all colliders.
struct ContactStep {
  double gap = 0;   // particles nearer to a collider than this are held off, >= 0 [m]
  double time = 0;  // at the end of the step [s]
  double step = 0;  // its length [s]
};

/// A collider over one step.
struct MovingCollider {
  const Collider* collider = nullptr;
  ColliderShape shape;  // at the end of the step
  Vec3 pivot = Vec3::Zero();
  Pose before, after;

  /// Velocity of the collider's material at p over the step [m/s].
  Vec3 velocity_at(const Vec3& p, double step) const;
};

/// Holds cloth off colliders, step by step. Keeps its work space between steps; what it does depends on the
/// arguments alone.
class ContactResponse {
 public:
  /// To be called first in every step: takes the colliders through it.
  void begin_step(const std::vector<Collider>& colliders, const ContactStep& step);

  /// The particles that may come too close during the step, by where they are and where they would fly to
  /// under `acceleration`. `state` is that at the start of the step; `mass` (num_particles) [kg] sets the
  /// stiffness. Particles marked in `is_pinned` are passed over.
  void find_contacts(const Vec3& acceleration, const std::vector<double>& mass,
                     const std::vector<char>& is_pinned, const ClothState& state,
                     std::vector<Contact>& contacts) const;

  /// At the end of the step, for every integrator: a particle nearer to a collider than the gap is set on its
  /// surface at that distance, stops approaching it, and is slowed along it by Coulomb friction:
  ///
  ///        v_n < 0:  Δv_n = −v_n          v, v_n, v_t relative to the collider's surface
  ///                  v_t ← v_t max(0, 1 − µ Δv_n/|v_t|)
  ///
  /// Pinned particles are left where they are. Only particles are tested, not triangles.
  void hold_off(const std::vector<char>& is_pinned, JobSystem& jobs, ClothState& state);

 private:
  ContactStep step_;
  std::vector<MovingCollider> moving_;
  std::vector<char> is_near_;  // (num_particles) work space of hold_off
};

}  // namespace weft
