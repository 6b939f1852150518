#pragma once
/// Private to integrators/: floating components, the pieces of cloth without pins.

#include <array>
#include <span>
#include <vector>

#include "weft/core/padded_rows.h"
#include "weft/core/vec3_array.h"
#include "weft/model/cloth_model.h"

namespace weft::engine {

/// Floating components: pieces of a cloth connected by springs, elements or seams, without a pinned particle.
class FloatingComponents {
 public:
  void find(const ClothModel& model, const std::vector<int>& pinned);

  int size() const { return count_; }
  int component_of(int particle) const {
    return component_.empty() ? -1 : component_[particle];
  }  // -1: held by a pin

 private:
  int count_ = 0;
  std::vector<int> component_;  // (num_particles) -1: pinned or tied to a pin; empty if there are none
};

/// The floating components of several cloths, joined by the contacts between them. Neither springs nor such
/// contacts move the centre of a component that nothing else touches: this conserves momentum.
class FreeBodies {
 public:
  struct Member {
    const FloatingComponents* components = nullptr;
    const PaddedRows* rows = nullptr;
    const std::vector<float>* weight = nullptr;  // D, laid out by the rows [N/m]
    bool is_held = false;                        // an external force acts on all of it
  };
  void begin(std::span<const Member> members);

  /// A particle of a member.
  struct Place {
    int member = 0, particle = 0;
  };

  /// Effect of a contact: joins the components of its particles if they push each other, else holds them.
  void release();
  void touch(std::span<const Place> places, bool is_mutual);

  /// Subtracts from the displacements of each floating component their mean, weighted by D (members).
  void remove_mean(std::span<Vec3Array* const> displacements);

 private:
  int root_of(int component) const;
  int component_of(const Place& place) const;

  std::vector<Member> members_;
  std::vector<int> first_component_;  // (members + 1)
  std::vector<int> parent_;           // (pieces)
  std::vector<char> is_held_;         // (pieces) counts at roots
  std::vector<Vec3> moment_;
  std::vector<double> weight_;
};

}  // namespace weft::engine
