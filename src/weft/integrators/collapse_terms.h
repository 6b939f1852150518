#pragma once
/// Private to integrators/: the triangles' resistance to collapse (forces/collapse.h) in the potential of
/// `newton`.

#include <array>
#include <memory>
#include <vector>

#include "weft/forces/collapse.h"
#include "weft/forces/narrow_triangles.h"
#include "weft/integrators/newton_term.h"

namespace weft::engine {

/// Σ W over the narrow triangles of the last linearise(): those with W > 0, and those that a Newton step may
/// narrow that far. All others have W = 0. The preconditioner needs no change: see CollapseHessian.
class CollapseTerms final : public NewtonTerm {
 public:
  void begin(const Step& step) override;
  double energy(const Place& at, JobSystem& jobs) override;
  double linearise(const Place& at, JobSystem& jobs, Vec3Array& force) override;
  double add_product(const Vec3Array& p, JobSystem& jobs, Vec3Array& q) override;

 private:
  struct Narrow {
    std::array<int, 3> at;  // indices into the rows
    RestTriangle rest;
  };
  struct Active {
    std::array<int, 3> at;
    CollapseHessian hessian;
  };

  std::uint64_t model_id_ = 0;
  std::shared_ptr<const ClothTopology> topology_;
  PaddedRows rows_;
  StrainLimit law_;
  NarrowTriangles finder_;
  std::vector<Narrow> narrow_;
  std::vector<Active> active_;
};

}  // namespace weft::engine
