#pragma once
/// Private to integrators/: seams (forces/seam_springs.h) in the potential of `newton`.

#include <vector>

#include "weft/core/padded_rows.h"
#include "weft/core/vec3_array.h"
#include "weft/forces/seam_springs.h"

namespace weft::engine {

/// Positions are floats, laid out by the rows; sums are doubles, one spring after the other.
class SeamTerms {
 public:
  /// `state` is the state at the start of the step; its seams close by the step [s].
  void begin(const ClothModel& model, const PaddedRows& rows, double step, ClothState& state);

  /// The value [J]; adds the forces, and stores the Hessian.
  double linearise(const Vec3Array& x, Vec3Array& force);

  double energy(const Vec3Array& x) const;

  /// q += H p, and p·Hp [J].
  double add_product(const Vec3Array& p, Vec3Array& q) const;

 private:
  void add(const SeamSpring& spring, const Vec3& force, Vec3Array& to) const;

  const ClothModel* model_ = nullptr;  // outlives the step
  PaddedRows rows_;
  double opening_ = 0;
  struct Pulled {
    const SeamSpring* spring;
    Mat3 hessian;
  };
  std::vector<Pulled> pulled_;
};

}  // namespace weft::engine
