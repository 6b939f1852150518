#pragma once
/// Preconditioned conjugate gradients in floats, for matrices that are only known by what they do.

#include "weft/core/job_system.h"
#include "weft/core/vec3_array.h"

namespace weft {

struct CgSettings {
  int iterations = 10;  // at most [1]
  /// Stops once an iteration lowers ½ xᵀAx − bᵀx by less than this share of what all have; 0: never. Not the
  /// residual: in floats, and for cloth, that says little of how good x is [1].
  double enough = 0;
  int least = 1;  // iterations before that share counts [1]
};

struct CgReport {
  int iterations = 0;   // made [1]
  double decrease = 0;  // of ½ xᵀAx − bᵀx, from x = 0 [J]
};

class ConjugateGradients {
 public:
  /// Solves A x = b from x = 0. multiply(p, q) computes q = A p and returns p·q; precondition(r, z) computes
  /// z ≈ A⁻¹ r and returns r·z. Both work in a fixed order, so the result has the same bits for any number of
  /// threads. Stops early where A or the preconditioner turn out not to be positive definite.
  template <class Multiply, class Precondition>
  CgReport solve(const Multiply& multiply, const Precondition& precondition, const Vec3Array& b,
                 const CgSettings& settings, JobSystem& jobs, Vec3Array& x) {
    begin(b, x);
    CgReport report;
    double rz = precondition(residual_, preconditioned_), beta = 0;
    while (report.iterations < settings.iterations && rz > 0) {
      turn(beta, jobs);
      const double curvature = multiply(direction_, product_);
      if (!(curvature > 0)) break;
      advance(rz / curvature, jobs, x);
      ++report.iterations;
      const double decrease = 0.5 * rz * rz / curvature;
      report.decrease += decrease;
      const bool is_enough = decrease < settings.enough * report.decrease;
      if (is_enough && report.iterations >= settings.least) break;
      if (report.iterations == settings.iterations) break;
      const double next = precondition(residual_, preconditioned_);
      beta = next / rz;
      rz = next;
    }
    return report;
  }

 private:
  void begin(const Vec3Array& b, Vec3Array& x);               // r = b, x = p = 0
  void turn(double beta, JobSystem& jobs);                    // p = z + β p
  void advance(double alpha, JobSystem& jobs, Vec3Array& x);  // x += α p, r −= α A p

  Vec3Array residual_, preconditioned_, direction_, product_;
};

}  // namespace weft
