#pragma once
/// Private to integrators/: contacts in the potential of `newton`.

#include <array>
#include <span>
#include <vector>

#include "weft/contact/contact.h"
#include "weft/core/padded_rows.h"
#include "weft/core/vec3_array.h"
#include "weft/integrators/contact_filter.h"
#include "weft/integrators/free_pieces.h"
#include "weft/integrators/integrator.h"
#include "weft/solvers/conjugate_gradients.h"

namespace weft::engine {

/// A contact's depth under a weight is some micrometres, and no solve goes that far: what it has left over at
/// the particles of contacts that push is theirs, and goes to their forces. `left` is the sum of all forces
/// at each particle, those of contacts and of inertia too; what is pinned has no say. `at` (contacts) are
/// indices into both [N].
void give_rest_to_contacts(std::span<const std::array<int, 4>> at, const std::vector<Vec3>& left,
                           const std::vector<char>& is_pinned, std::span<Contact* const> contacts);

/// Σ ½ k max(0, offset − n·Σ w x)² + ½ κ |slide|², in double precision, contact by contact. κ is chosen anew
/// at each linearise(), such that κ |slide| becomes Coulomb's force µ N at the slide that is expected after
/// the solve; slides slower than 1 mm/s count as sticking. N is guessed before the solve, and never taken as
/// more than half as much again: a solve that is not finished holds what should come off, and leaves forces
/// behind that are many times too large; friction that has stuck by them would not let go.
///
/// The contacts are those of a group of cloths, its members.
class ContactTerms {
 public:
  struct Member {
    const ClothModel* model = nullptr;
    const PinTargets* pins = nullptr;
    const PaddedRows* rows = nullptr;
    int first_particle = 0;  // in the contacts' numbers
  };

  /// Where the particles of a member are: y + e.
  struct Positions {
    const Vec3Array* target = nullptr;
    const Vec3Array* offset = nullptr;
  };

  /// Diagonals and filter of a member's preconditioners [N/m].
  struct Preconditioners {
    std::vector<float>* stiff = nullptr;  // whatever the direction
    std::vector<float>* along = nullptr;  // along surfaces alone
    ContactFilter* filter = nullptr;
  };

  /// Takes those of `contacts` that are in `which`, and forgets the ones before. `driven`: displacement in
  /// the step by gravity alone [m].
  void begin(std::span<Contact> contacts, std::span<const int> which, std::span<const Member> members,
             double step, const Vec3& driven);

  bool empty() const { return terms_.empty(); }

  /// Guesses what each will bear, and how far it will slide, from where inertia takes the particles: y
  /// (members).
  void guess(std::span<const Positions> y);

  /// What a solve leaves over at these positions, over what it may leave [1].
  struct Unrest {
    double lack = 0;      // the largest depth
    double friction = 0;  // by how much friction would change
  };
  Unrest find_unrest(std::span<const Positions> x);

  /// Sets Contact::is_solved of all.
  void set_solved(bool is_solved);

  /// Whether any of them pushes at these positions (members).
  bool any_active(std::span<const Positions> x);

  /// Sets is_pushed (members) for those that are pushed there.
  void find_pushed(std::span<const Positions> x, std::vector<char>& is_pushed);

  /// Its value [J]; adds its forces (members), and keeps its Hessian.
  double linearise(std::span<const Positions> x, std::span<Vec3Array* const> force);

  double energy(std::span<const Positions> x);

  /// Sets Contact::force from these positions, friction as in the last linearise(); `others` (members) are
  /// all other forces on particles, inertia's too [N].
  void compute_forces(std::span<const Positions> x, std::span<const Vec3Array* const> others);

  /// q += H p, and p·Hp [J] (blocks: members).
  double add_product(std::span<CgBlock* const> blocks);

  /// Adds what preconditioners must know of the Hessian (members).
  void add_to_preconditioners(std::span<const Preconditioners> preconditioners) const;

  /// Whether any pushed at the last linearise().
  bool is_active() const { return !active_.empty(); }

  /// Joins what pushes each other, and holds what is pushed from outside.
  void touch(FreeBodies& bodies) const;

 private:
  /// A particle that some contact is about.
  struct Point {
    int member = 0, particle = 0, at = 0;  // its index by the member's rows
    double mass_per_step = 0;              // m/h², 0 of pinned particles [N/m]
  };

  struct Term {
    Contact* contact = nullptr;
    std::array<int, 4> point;
    bool can_move = false;
    bool is_active = false;
    double inertia = 0;   // against displacements in a step, its share where many contacts bear [N/m]
    double guess = 0;     // of its force [N]
    double slide = 0;     // guess of its slide [m]
    double friction = 0;  // κ [N/m]
  };

  /// The Hessian of a contact that pushes.
  struct Spring {
    int num_particles;
    std::array<int, 4> point;
    std::array<double, 4> weight;
    Vec3 normal;
    double beyond_friction, friction;  // κ_n − κ, κ [N/m]
  };

  void find_points(std::span<const Member> members, double step);
  static Point make_point(std::span<const Member> members, int number, double step);
  void gather(std::span<const Positions> x);
  Vec3 point_of(const Term& term) const;
  double depth_of(const Term& term) const;
  Vec3 slide_of(const Term& term) const;
  static bool will_push(const Term& term, double beyond);
  double friction_stiffness(const Term& term, double depth, double slide) const;

  double sticking_ = 0;  // slide of a step that still sticks [m]
  Vec3 driven_ = Vec3::Zero();
  int num_linearised_ = 0;  // in this step
  std::vector<Point> points_;
  std::vector<int> number_;    // (particles of all bodies) in points_, -1: none
  std::vector<int> numbered_;  // particles that are
  std::vector<double> borne_;  // (points) Σ w² of the contacts that push
  std::vector<Vec3> x_, f_;    // (points) positions or directions; forces or products
  std::vector<Term> terms_;
  std::vector<Spring> active_;  // of those that pushed at the last linearise()
  std::vector<int> held_;       // terms that did
};

}  // namespace weft::engine
