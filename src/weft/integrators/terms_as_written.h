#pragma once
/// Private to integrators/: the terms without a kernel in the potential of `newton`.

#include <vector>

#include "weft/forces/terms.h"
#include "weft/integrators/newton_term.h"

namespace weft::engine {

class TermsAsWritten final : public NewtonTerm {
 public:
  void begin(const Step& step) override;
  double energy(const Place& at, JobSystem& jobs) override;
  double linearise(const Place& at, JobSystem& jobs, Vec3Array& force) override;
  double add_product(const Vec3Array& p, JobSystem& jobs, Vec3Array& q) override;

  /// Whether a stretch exceeds a strain limit; x as in Place.
  bool is_beyond_limit(const Vec3Array& x) const;

 private:
  struct Block {
    int i, j;  // indices of touched_
    Mat3 value;
  };

  std::vector<Vec3> load(const Vec3Array& x) const;
  int touch(int particle);

  PaddedRows rows_;
  int num_particles_ = 0;
  Terms terms_;
  std::vector<Block> blocks_;
  std::vector<Term::RankOne> rank_ones_;
  std::vector<int> touched_;     // particles with a block
  std::vector<int> touched_at_;  // (num_particles) its index there, −1: none
  std::vector<Vec3> in_, out_;   // (touched)
};

}  // namespace weft::engine
