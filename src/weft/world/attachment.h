#pragma once
/// Attachments: a patch of cloth on a damped spring whose other end is moved by the program.
///
///          o target            force on the patch  k (target − p) − c v, distributed over its particles
///         /
///        /  k, c               The spring is implicit: each particle i with its shares k_i, c_i enters the
///     ──p── cloth              integrator with a larger mass, and with another start velocity,
///
///                                  m̃ = m + h c_i + h² k_i
///                                  ṽ = (m (v + h g) + h k_i (target_i − x)) / m̃ − h g.
///
/// This is implicit Euler of spring and mass, written as inertia only. It works with any integrator, and for
/// any stiffness, mass and step: an attachment makes particles heavier, never less stable.

#include <memory>
#include <vector>

#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"
#include "weft/world/surface_anchor.h"

namespace weft::engine {

struct Attachment {
  std::vector<int> particles;
  std::vector<double> shares;  // of the spring (particles), sum 1 [1]
  std::vector<Vec3> offsets;   // of each particle from the held point, constant while held (particles) [m]
  double stiffness = 0;        // k, >= 0 [N/m]
  double damping = 0;          // c, against motion of the patch, >= 0 [N·s/m]
  Vec3 target = Vec3::Zero();  // target of the held point [m]
  int follow = -1;             // collider that the target follows; -1: none
  SurfaceAnchor anchor;        // of the target on it
};

/// Attachment at the point of a triangle with the given corner weights (sum 1), with its surroundings: smooth
/// shares within one and a half of the triangle's longest edge, or `radius` if that is more, at rest [m]. The
/// target is the point's present position; the spring follows in about 70 ms and sags by 1 cm under the whole
/// cloth.
Attachment make_attachment(const ClothModel& model, const ClothState& state, int triangle,
                           const Vec3& weights, double radius = 0.03);

/// Private to the world: the attachments of one cloth, in a step.
class Attachments {
 public:
  void set(std::vector<Attachment> attachments) {
    attachments_ = std::move(attachments);
    model_ = nullptr;
  }
  void set_target(int attachment, const Vec3& target) { attachments_[attachment].target = target; }
  void set_anchor(int attachment, const SurfaceAnchor& anchor) { attachments_[attachment].anchor = anchor; }
  int size() const { return static_cast<int>(attachments_.size()); }
  bool are_empty() const { return attachments_.empty(); }
  const std::vector<Attachment>& attachments() const { return attachments_; }

  /// Changes the velocities of held particles, and returns the model to integrate with.
  const ClothModel& begin(const std::shared_ptr<const ClothModel>& model, const std::vector<char>& is_pinned,
                          const Vec3& gravity, double step, ClothState& state);

  /// Impulse of the springs on the cloth in the integrated step [N·s].
  Vec3 impulse(const std::vector<char>& is_pinned, double step, const ClothState& state) const;

 private:
  void fit(const std::shared_ptr<const ClothModel>& model, double step);

  std::vector<Attachment> attachments_;

  // The heavier model, its heavier particles, and its source.
  std::shared_ptr<const ClothModel> model_, original_;
  std::vector<int> held_;
  double step_ = 0;
};

}  // namespace weft::engine
