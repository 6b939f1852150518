#pragma once
/// What a solve with contacts knew, and which cloths it separated.

#include <array>
#include <span>
#include <vector>

#include "weft/contact/constraint.h"
#include "weft/contact/contact.h"
#include "weft/contact/step_bodies.h"

namespace weft::engine {

class SolvedContacts {
 public:
  /// The constraints that the solve gets.
  void set(std::vector<Constraint>& constraints) { constraints_.swap(constraints); }
  const std::vector<Constraint>& constraints() const { return constraints_; }

  /// Reads the solved contacts, one for each constraint; none: no cloth is separated unless `is_predicted`.
  void read(std::span<const Contact> contacts, const Numbering& numbering, bool is_predicted);

  /// Whether every cloth is separated from all its known contacts.
  bool are_all_separated() const;

  /// Drops the constraints of cloths that the solve separated and that touch only such cloths.
  void leave_out_separated(const StepBodies& bodies, std::vector<Constraint>& constraints);

  /// Marks the constraints that the solve had. Call it before is_known().
  void sort_known();
  bool is_known(const Constraint& c) const;

 private:
  using FeatureKey = std::array<int, 5>;  // shape and vertices, -1 beyond the last
  static FeatureKey key_of(const Constraint& c);
  bool is_separated(const Constraint& c, const Numbering& numbering) const;
  bool mark_near(const Constraint& c, const Numbering& numbering);

  std::vector<Constraint> constraints_;
  std::vector<char> is_separated_;  // (cloths)
  std::vector<FeatureKey> known_;   // of constraints_, sorted
};

}  // namespace weft::engine
