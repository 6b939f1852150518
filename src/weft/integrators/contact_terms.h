#pragma once
/// Private to integrators/: contacts in the potential of `newton`.

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "weft/contact/contact.h"
#include "weft/core/padded_rows.h"
#include "weft/core/vec3_array.h"
#include "weft/integrators/contact_preconditioner.h"
#include "weft/integrators/floating_components.h"
#include "weft/integrators/integrator.h"
#include "weft/solvers/conjugate_gradients.h"

namespace weft::engine {

/// Distributes the solve's residual to contact forces. Under a weight a contact is only some micrometres
/// deep, and no solve is that accurate: the residual at particles of active contacts belongs to these
/// contacts. `left` is the sum of all forces at each particle, including contact and inertial forces; pinned
/// particles are ignored. `at` (contacts) are indices into both [N].
void give_rest_to_contacts(std::span<const std::array<int, 4>> at, const std::vector<Vec3>& left,
                           const std::vector<char>& is_pinned, std::span<Contact* const> contacts);

/// Contact and friction potential: Σ ½ k max(0, offset − n·Σ w x)² + ½ κ |slide|², in double precision,
/// contact by contact. Each linearise() recomputes κ such that κ |slide| becomes Coulomb's force µ N at the
/// slide expected after the solve; slides slower than 1 mm/s count as sticking. N is estimated before the
/// solve, and limited to three times that estimate, or to one and a half times the force that lasted two steps.
/// An unfinished solve holds cloth that should come off, and its forces are many times too large; friction
/// based on them would not release it.
///
/// The contacts are those of a group of cloths, its members.
class ContactTerms {
 public:
  struct Member {
    const ClothModel* model = nullptr;
    const PinTargets* pins = nullptr;
    const PaddedRows* rows = nullptr;
    int first_particle = 0;  // under the contacts' numbering
  };

  /// Positions of a member's particles: y + e.
  struct Positions {
    const Vec3Array* target = nullptr;
    const Vec3Array* offset = nullptr;
  };

  /// Diagonals and contact filter of a member's preconditioners [N/m].
  struct Preconditioners {
    std::vector<float>* stiff = nullptr;  // for all directions
    std::vector<float>* along = nullptr;  // along surfaces only
    ContactPreconditioner* preconditioner = nullptr;
  };

  /// Takes those of `contacts` that are in `which`, and discards earlier ones. `driven`: displacement in the
  /// step by gravity only [m].
  void begin(std::span<Contact> contacts, std::span<const int> which, std::span<const Member> members,
             double step, const Vec3& driven);

  bool empty() const { return rows_.empty(); }

  /// Estimates each contact's force and slide, from the inertial prediction y of the particles (members).
  void guess(std::span<const Positions> y);

  /// Residual of a solve at these positions, relative to its tolerances [1].
  struct Unrest {
    double shortfall = 0;       // the largest depth
    double friction = 0;        // sum of the changes of friction that another linearise() would make
    double total_friction = 0;  // change of the sum of all friction
  };
  Unrest find_unrest(std::span<const Positions> x);

  /// Sets Contact::is_solved and Contact::push of all contacts, and is_pushed (members) for those that a contact
  /// pushes at these positions.
  void finish(std::span<const Positions> x, std::vector<char>& is_pushed);

  /// Whether any contact pushes at these positions (members).
  bool any_active(std::span<const Positions> x);

  /// Returns the value [J]; adds the forces (members), and stores the Hessian.
  double linearise(std::span<const Positions> x, std::span<Vec3Array* const> force);

  double energy(std::span<const Positions> x);

  /// Sets Contact::force from these positions, with friction as in the last linearise(); `others` (members)
  /// are all other forces on particles, including inertial ones [N].
  void compute_forces(std::span<const Positions> x, std::span<const Vec3Array* const> others);

  /// q += H p, and p·Hp [J] (blocks: members).
  double add_product(std::span<CgBlock* const> blocks);

  /// Adds the contacts' contribution to preconditioners (members).
  void add_to_preconditioners(std::span<const Preconditioners> preconditioners) const;

  /// Whether any contact pushed at the last linearise().
  bool is_active() const { return !active_.empty(); }

  /// Joins pieces that push each other, and holds pieces that colliders push.
  void touch(FreeBodies& bodies) const;

 private:
  /// A particle of some contact.
  struct Point {
    int member = 0, particle = 0, at = 0;  // its index into the member's rows
    double mass_per_step = 0;              // m/h², 0 for pinned particles [N/m]
  };

  /// A contact in the form that all passes read: two cache lines.
  struct Row {
    std::array<int, 4> point;
    std::array<double, 4> weight;
    Vec3 normal, stick_point;
    double offset = 0, stiffness = 0;  // as in Contact
    double friction = 0;               // κ [N/m]
    std::int16_t num_particles = 0;
    bool is_mutual = false, can_move = false, is_active = false, has_pushed = false;

    /// Σ w x.
    Vec3 sum(const std::vector<Vec3>& x) const {
      Vec3 sum = weight[0] * x[point[0]];
      for (int k = 1; k < num_particles; ++k) sum += weight[k] * x[point[k]];
      return sum;
    }
    double beyond(const Vec3& at) const { return offset - normal.dot(at); }
    double depth(const Vec3& at) const { return std::max(0.0, beyond(at)); }
    Vec3 slide(const Vec3& at) const {
      const Vec3 moved = at - stick_point;
      return moved - moved.dot(normal) * normal;
    }
  };
  static_assert(sizeof(Row) == 128);

  /// What estimates of a contact's force need, in the rows' order.
  struct Estimate {
    Contact* contact = nullptr;
    double coefficient = 0;    // Coulomb's [1]
    double gap = 0;            // [m]
    double lasting_force = 0;  // [N]
    double inertia = 0;        // m/h² of the stencil, shared where several contacts bear [N/m]
    double force = 0;          // [N]
    double slide = 0;          // [m]
    double stiffened = 1;      // factor on the contact's stiffness, of this step [1]
  };

  /// The Hessian of an active contact.
  struct Spring {
    std::array<int, 4> point;
    std::array<double, 4> weight;
    Vec3 normal;
    double stiffness, friction;  // [N/m]
    int num_particles;
    bool is_mutual;
  };

  void find_points(std::span<const Member> members, double step);
  static Point make_point(std::span<const Member> members, int number, double step);
  void gather(std::span<const Positions> x);
  static void stiffen(Row& row, Estimate& estimate);
  static bool will_push(const Row& row, const Estimate& estimate, double beyond);
  static double most_push(const Estimate& estimate);
  double friction_stiffness(const Row& row, const Estimate& estimate, double depth, double slide) const;

  double sticking_ = 0;  // largest slide in a step that counts as sticking [m]
  Vec3 driven_ = Vec3::Zero();
  int num_linearised_ = 0;  // in this step
  std::vector<Point> points_;
  std::vector<int> number_;    // (particles of all bodies) index into points_, -1: none
  std::vector<int> numbered_;  // particles with such an index
  std::vector<double> borne_;  // (points) Σ w² over the pushing contacts
  std::vector<Vec3> x_, f_;    // (points) positions or directions; forces or products
  std::vector<Row> rows_;
  std::vector<Estimate> estimates_;  // (rows)
  std::vector<Spring> active_;       // contacts that pushed at the last linearise()
};

}  // namespace weft::engine
