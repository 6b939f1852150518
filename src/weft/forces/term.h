#pragma once
/// A term of the incremental potential of a cloth, in doubles: the statement of the method.
///
/// `implicit_euler` minimises the sum of all terms. Energies in reports and forces for readers are theirs too. `newton`
/// has kernels in floats for most of them, which the tests compare with these (forces/terms.h).

#include <functional>
#include <optional>
#include <vector>

#include "weft/core/vec.h"

namespace weft::engine {

enum class HessianKind {
  exact,     // possibly indefinite; of some terms without a part (Term::has_exact_hessian)
  positive,  // a positive semidefinite approximation
};

class Term {
 public:
  using Positions = std::vector<Vec3>;  // relative to the cloth's origin (num_particles) [m]
  using AddBlock = std::function<void(int i, int j, const Mat3& block)>;
  using AddPair = std::function<void(int i, int j)>;

  /// A part stiffness · gradient gradientᵀ of a Hessian, which couples all particles.
  struct RankOne {
    double stiffness;
    std::vector<Vec3> gradient;  // (num_particles)
  };

  virtual ~Term() = default;

  virtual double energy(const Positions& x) const = 0;  // [J]

  /// Adds minus the gradient (num_particles) [N].
  virtual void add_force(const Positions& x, std::vector<Vec3>& force) const = 0;

  /// Passes the Hessian's blocks [N/m]: those of i = j, and of each pair i ≠ j in one order only, all of them once
  /// or in parts.
  virtual void add_hessian(const Positions& x, HessianKind kind, const AddBlock& add) const = 0;

  /// Passes all pairs i ≠ j that add_hessian() may pass, once or more often.
  virtual void list_pairs(const AddPair& add) const = 0;

  /// A part of both Hessians that add_hessian() does not pass.
  virtual std::optional<RankOne> rank_one(const Positions&) const { return std::nullopt; }

  /// Whether the exact Hessian has every part. The others would hardly help an implicit step.
  virtual bool has_exact_hessian() const { return true; }

  /// Whether a stretch exceeds a strain limit by more than a solver may leave.
  virtual bool is_beyond_limit(const Positions&) const { return false; }

 protected:
  /// Passes block(a, b) of each two of a few particles, and of each with itself.
  template <class Block>
  static void add_all_blocks(const int* particles, int count, const Block& block, const AddBlock& add) {
    for (int a = 0; a < count; ++a) {
      for (int b = 0; b <= a; ++b) add(particles[a], particles[b], block(a, b));
    }
  }

  /// Passes the pairs of a few particles, some of which may be the same.
  static void list_all_pairs(const int* particles, int count, const AddPair& add) {
    for (int a = 0; a < count; ++a) {
      for (int b = 0; b < a; ++b) {
        if (particles[a] != particles[b]) add(particles[a], particles[b]);
      }
    }
  }
};

}  // namespace weft::engine
