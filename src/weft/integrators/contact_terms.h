#pragma once
/// Private to integrators/: contacts in the potential of `newton`.

#include <array>
#include <span>
#include <vector>

#include "weft/contact/contact.h"
#include "weft/core/padded_rows.h"
#include "weft/core/vec3_array.h"
#include "weft/integrators/contact_filter.h"
#include "weft/integrators/integrator.h"

namespace weft {

/// Places of particles: y + e.
struct OffsetPositions {
  const PaddedRows& rows;
  const Vec3Array& target;
  const Vec3Array& offset;

  Vec3 operator[](int particle) const {
    const int at = rows.index(particle);
    return target.get(at) + offset.get(at);
  }
};

/// A contact's depth under a weight is some micrometres, and no solve goes that far: what it has left over at
/// the particles of contacts that push is theirs. `left` (num_particles) is the sum of all forces there,
/// those of contacts and of inertia too, 0 at pins; `forces` (contacts) [N].
void give_rest_to_contacts(std::span<const Contact* const> contacts, const std::vector<Vec3>& left,
                           std::vector<Vec3>& forces);

/// Σ ½ k max(0, offset − n·Σ w x)² + ½ κ |slide|², in double precision, contact by contact. κ is chosen anew
/// at each linearise(), such that κ |slide| becomes Coulomb's force µ N at the slide that is expected after
/// the solve; slides slower than 1 mm/s count as sticking. N is guessed before the solve, and never taken as
/// more than half as much again: a solve that is not finished holds what should come off, and leaves forces
/// behind that are many times too large; friction that has stuck by them would not let go.
class ContactTerms {
 public:
  /// Forgets the contacts before. `driven`: displacement in the step by gravity and wind alone [m].
  void begin(const std::vector<Contact>& contacts, const ClothModel& model, const PinTargets& pins,
             double step, const Vec3& driven);

  bool empty() const { return terms_.empty(); }

  /// Whether any of them pushes at these positions.
  bool any_active(const OffsetPositions& x) const;

  /// Its value [J]; adds its forces, and keeps its Hessian.
  double linearise(const OffsetPositions& x, Vec3Array& force);

  double energy(const OffsetPositions& x) const;

  /// The force on each contact's point at these positions, friction as in the last linearise() (contacts);
  /// `others` are all other forces on particles, inertia's too [N].
  void compute_forces(const OffsetPositions& x, const Vec3Array& others, std::vector<Vec3>& forces) const;

  /// q += H p, and p·Hp [J].
  double add_product(const Vec3Array& p, Vec3Array& q) const;

  /// Adds what preconditioners must know of the Hessian: to `stiff` its largest stiffness, whatever the
  /// direction, to `along` that along surfaces alone [N/m], and the normals to the filter.
  void add_to_preconditioners(const PaddedRows& rows, std::vector<float>& stiff, std::vector<float>& along,
                              ContactFilter& filter) const;

  /// Whether each contact has pushed at any linearise() since begin() (contacts).
  std::span<const char> have_pushed() const { return have_pushed_; }

  /// Calls body(contact) for those that pushed at the last linearise().
  template <class Body>
  void for_active(const Body& body) const {
    for (const Term& t : terms_) {
      if (t.is_active) body(*t.contact);
    }
  }

 private:
  struct Term {
    const Contact* contact = nullptr;
    bool can_move = false;
    bool is_active = false;
    double inertia = 0;   // against displacements in a step, its share where many contacts bear [N/m]
    double guess = 0;     // of its force [N]
    double friction = 0;  // κ [N/m]
  };

  /// The Hessian of a contact that pushes.
  struct Spring {
    int num_particles;
    std::array<int, 4> at;  // indices by the rows
    std::array<double, 4> weight;
    Vec3 normal;
    double beyond_friction, friction;  // κ_n − κ, κ [N/m]
  };

  void guess_forces(const OffsetPositions& x);
  double friction_stiffness(const Term& term, double depth, const Vec3& slide) const;

  double sticking_ = 0;  // slide of a step that still sticks [m]
  Vec3 driven_ = Vec3::Zero();
  int num_linearised_ = 0;             // in this step
  std::vector<double> mass_per_step_;  // (num_particles) m/h², 0 of pinned particles [N/m]
  std::vector<double> borne_;          // (num_particles) Σ w² of the contacts that push
  std::vector<Term> terms_;
  std::vector<Spring> active_;  // of those that pushed at the last linearise()
  std::vector<char> have_pushed_;
};

}  // namespace weft
