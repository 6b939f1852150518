#pragma once
/// Hands: a patch of cloth held by a damped spring whose other end moves as it is told.
///
///          o target            force on the patch  k (target − p) − c v, shared out among its particles
///         /
///        /  k, c               The spring is implicit: each particle i with its shares k_i, c_i goes through
///        the
///     ──p──                    integrator heavier, and with another velocity to start from,
///     cloth
///                                  m̃ = m + h c_i + h² k_i
///                                  ṽ = (m (v + h g) + h k_i (target_i − x)) / m̃ − h g,
///
/// which is implicit Euler of spring and mass written as inertia alone. So any integrator can hold cloth, and
/// no stiffness, mass or step is too large: a hand can only make its particles heavier, never less stable.

#include <memory>
#include <vector>

#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

struct Grab {
  std::vector<int> particles;
  std::vector<double> shares;  // of the spring (particles), sum 1 [1]
  std::vector<Vec3> offsets;   // of each particle from the held point, kept while it is held (particles) [m]
  double stiffness = 0;        // k, >= 0 [N/m]
  double damping = 0;          // c, against motion of the patch, >= 0 [N·s/m]
  Vec3 target = Vec3::Zero();  // where the held point is drawn to [m]
};

/// The point of a triangle with the given weights of its corners (sum 1), held with its surroundings: smooth
/// shares within one and a half of the triangle's longest edge, or `radius` if that is more, at rest [m]. The
/// target is where the point is now; the spring follows in about 70 ms and sags by 1 cm under the whole
/// cloth.
Grab make_grab(const ClothModel& model, const ClothState& state, int triangle, const Vec3& weights,
               double radius = 0.03);

/// Private to the world: the hands on one cloth, through a step.
class Hands {
 public:
  void set(std::vector<Grab> grabs) {
    grabs_ = std::move(grabs);
    model_ = nullptr;
  }
  void set_target(int grab, const Vec3& target) { grabs_[grab].target = target; }
  int size() const { return static_cast<int>(grabs_.size()); }
  bool are_empty() const { return grabs_.empty(); }
  const std::vector<Grab>& grabs() const { return grabs_; }

  /// Changes the velocities of what is held, and returns the model to integrate with.
  const ClothModel& begin(const std::shared_ptr<const ClothModel>& model, const std::vector<char>& is_pinned,
                          const Vec3& gravity, double step, ClothState& state);

  /// What the springs gave to the cloth in a step that has been integrated [N·s].
  Vec3 impulse(const std::vector<char>& is_pinned, double step, const ClothState& state) const;

 private:
  void fit(const std::shared_ptr<const ClothModel>& model, double step);

  std::vector<Grab> grabs_;

  // The heavier model, which particles are heavier, and what it was made from.
  std::shared_ptr<const ClothModel> model_, original_;
  std::vector<int> held_;
  double step_ = 0;
};

}  // namespace weft::engine
