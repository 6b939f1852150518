#pragma once
/// Contact forces of cloth on cloth that last: warm start of the solve by the forces of earlier steps.
///
/// Stiff cloth in folds presses its particles with many times their weight, which neither their inertia nor
/// their positions tell. A contact that bore a force in the last two steps is expected to bear it again; the
/// force of a single step, as of an impact, does not count. Forces are kept per particle, because pairs change
/// while cloth slides. Contacts with colliders have no memory: skin that pinches cloth presses without limit, and
/// cloth that then moves with a limb would be torn.

#include <vector>

#include "weft/contact/constraint.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

class ContactMemory {
 public:
  /// Begins a step of cloths with so many particles in all, and forgets earlier ones.
  void begin_step(int num_particles);

  /// Reads and writes what a cloth remembers; its first particle has this number.
  void read(int first, const ClothState& state);
  void store(int first, ClothState& state) const;

  /// Forgets the forces of this step: it is solved again.
  void restart();

  /// The constraint bears a normal force in this step [N].
  void add(const Constraint& c, double force);

  /// Whether cloth pressed both sides of a cloth–cloth pair in the last step.
  bool was_pressed(const Constraint& c) const;

  /// The normal force that the constraint bore in both of the last two steps, about; 0 with a collider [N].
  double lasting_force(const Constraint& c) const;

 private:
  /// Forces of contacts on a particle.
  struct Sum {
    float force = 0, weight = 0;  // Σ |w| N [N] and Σ |w| [1] over its contacts
    float mean() const { return weight > 0 ? force / weight : 0; }
  };

  bool is_of_cloths(const Constraint& c) const;

  std::vector<float> last_, lasting_;  // (num_particles) [N]
  std::vector<Sum> sums_;              // (num_particles) of this step
};

}  // namespace weft::engine
