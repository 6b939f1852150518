#pragma once
/// Private to integrators/: a cloth in the system that `implicit_euler` solves: its potential without
/// contacts, in double precision, and the step from start to end state.

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "weft/forces/collapse.h"
#include "weft/forces/pressure.h"
#include "weft/forces/seam_springs.h"
#include "weft/forces/thread_bends.h"
#include "weft/integrators/air_terms.h"
#include "weft/integrators/element_terms.h"
#include "weft/integrators/integrator.h"

namespace weft::engine {

enum class Order { first, second };
enum class Keeps { floats, doubles };

class ImplicitCloth {
 public:
  /// Prepares the cloth for a step of implicit Euler: x is the inertial prediction.
  void begin(const Body& body, double step, Order order, Keeps keeps);

  /// Whether contact was active in the last step.
  bool is_first_order() const {
    return state_->history.is_held || (state_->history.step > 0 && state_->history.had_contact);
  }

  /// Switches the step to BDF2.
  void begin_second_order();

  /// Sets the start of the solve. Call it last.
  void place_pins();

  double energy(const std::vector<Vec3>& x) const;  // [J]

  /// Adds the cloth's gradient at x (num_particles) [N].
  void add_gradient(const std::vector<Vec3>& x, std::vector<Vec3>& gradient) const;

  /// Passes the Hessian at x block by block, i < j or i = j; the first num_springs() blocks off the diagonal
  /// are those of springs, in order. Positive semidefinite unless `is_true` is set.
  using AddBlock = std::function<void(int i, int j, const Mat3& block)>;
  using SetSpring = std::function<void(int spring, const Mat3& block)>;
  void add_hessian(const std::vector<Vec3>& x, bool is_true, const AddBlock& add,
                   const SetSpring& set_spring) const;

  /// The part stiffness ∂V ∂Vᵀ of the Hessian, of sealed gas: it couples all particles; pins are not set to
  /// zero.
  struct GasHessian {
    double stiffness;            // [Pa/m³]
    std::vector<Vec3> gradient;  // ∂V (num_particles) [m²]
  };
  std::optional<GasHessian> gas_hessian(const std::vector<Vec3>& x) const;

  /// Particle pairs besides springs that the Hessian couples.
  std::vector<std::pair<int, int>> find_element_pairs() const;

  /// Whether a stretch exceeds a strain limit.
  bool is_beyond_limit(const std::vector<Vec3>& x) const;

  /// Stores the motion that ends at x.
  void finish(const std::vector<Vec3>& x, bool is_pushed);

  const ClothModel& model() const { return *model_; }
  const std::vector<int>& pinned() const { return environment_->pins.particle; }
  bool is_pinned(int i) const { return is_pinned_[i] != 0; }
  int num_springs() const { return static_cast<int>(model_->topology->springs.size()); }
  const std::vector<Vec3>& inertial() const { return inertial_; }  // y, relative to the origin [m]
  const std::vector<Vec3>& placed() const { return placed_; }      // y with pins at their end positions [m]
  double effective_step() const { return step_; }                  // T [s]

 private:
  void load();
  void start_from(const std::vector<Vec3>& x, const std::vector<Vec3>& v, double time);
  void synthesize_history();
  void find_triangles();
  bool is_damped() const { return model_->material.damping > 0 || model_->material.damping_time > 0; }
  const Spring& spring(int k) const { return model_->topology->springs[k]; }
  Vec3 relative_velocity(const Spring& s, const std::vector<Vec3>& x) const;
  Vec3 damping_force(int k, const Vec3& w) const;
  Mat3 damping_jacobian(int k) const;
  bool is_limited(const Spring& s) const;
  LimitResponse limit_of(const Spring& s, const std::vector<Vec3>& x) const;
  Mat3 limit_jacobian(const Spring& s, const std::vector<Vec3>& x) const;
  /// Calls visit(spring, pull) for each seam spring that is not slack.
  template <class Visit>
  void visit_seams(const std::vector<Vec3>& x, const Visit& visit) const {
    visit_seam_pulls(
        *model_, seam_opening(*model_, *state_), [&](int v) { return x[v]; }, visit);
  }
  ThreadBendResponse thread_response(int row, const std::vector<Vec3>& x) const;
  double volume(const std::vector<Vec3>& x) const;
  void add_spring_gradient(const std::vector<Vec3>& x, std::vector<Vec3>& gradient) const;

  Order order_ = Order::first;
  Keeps keeps_ = Keeps::floats;
  const ClothModel* model_ = nullptr;
  const Environment* environment_ = nullptr;
  ClothState* state_ = nullptr;
  std::shared_ptr<const ClothTopology> topology_;  // of triangles_
  std::vector<MembraneElement> triangles_;         // all
  StrainLimit collapse_law_;
  ThreadBendStep thread_bends_;
  ElementTerms elements_;
  AirTerms air_;
  double whole_step_ = 0;  // h [s]
  double step_ = 0;        // T [s]
  PreciseState before_;    // at the start of the step
  std::vector<char> is_pinned_;
  std::vector<Vec3> start_, inertial_, placed_, damped_shape_, velocity_;
};

}  // namespace weft::engine
