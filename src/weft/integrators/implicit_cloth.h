#pragma once
/// Private to integrators/: a cloth in the system that `implicit_euler` solves. It has the terms of the potential without
/// contacts (forces/terms.h), and the step from start to end state.

#include <utility>
#include <vector>

#include "weft/forces/terms.h"
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

  /// Sets the start of the solve, and the terms. Call it last.
  void place_pins();

  /// Σ of them is the potential.
  const Terms& terms() const { return terms_; }

  /// All pairs i < j that Hessians of this topology and these elements may couple, sorted. Nothing else matters.
  std::vector<std::pair<int, int>> find_pairs() const;

  /// Stores the motion that ends at x.
  void finish(const std::vector<Vec3>& x, bool is_pushed);

  const ClothModel& model() const { return *model_; }
  const std::vector<int>& pinned() const { return environment_->pins.particle; }
  bool is_pinned(int i) const { return is_pinned_[i] != 0; }
  const std::vector<Vec3>& inertial() const { return inertial_; }  // y, relative to the origin [m]
  const std::vector<Vec3>& placed() const { return placed_; }      // y with pins at their end positions [m]
  double effective_step() const { return step_; }                  // T [s]

 private:
  void load();
  void start_from(const std::vector<Vec3>& x, const std::vector<Vec3>& v, double time);
  void synthesize_history();
  void make_terms();

  Order order_ = Order::first;
  Keeps keeps_ = Keeps::floats;
  const ClothModel* model_ = nullptr;
  const Environment* environment_ = nullptr;
  ClothState* state_ = nullptr;
  Terms terms_;
  double whole_step_ = 0;  // h [s]
  double step_ = 0;        // T [s]
  PreciseState before_;    // at the start of the step
  std::vector<char> is_pinned_;
  std::vector<Vec3> start_, inertial_, placed_, velocity_;
};

}  // namespace weft::engine
