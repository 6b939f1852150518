#pragma once
/// Preconditioned conjugate gradients in floats, matrix-free.

#include <algorithm>
#include <cmath>
#include <span>

#include "weft/core/job_system.h"
#include "weft/core/vec3_array.h"

namespace weft::engine {

struct CgSettings {
  int iterations = 10;  // limit [1]
  /// Stops once an iteration lowers ½ xᵀAx − bᵀx by less than this share of the total decrease; 0: never. The
  /// residual is not used: in floats, and for cloth, it says little about the error of x [1].
  double enough = 0;
  int least = 1;  // minimum of iterations before `enough` applies [1]
};

struct CgReport {
  int iterations = 0;   // number made [1]
  double decrease = 0;  // of ½ xᵀAx − bᵀx, from x = 0 [J]
  double residual = 0;  // √(r·P⁻¹r) before the last iteration, as a share of that of b [1]
};

/// One block of the vectors, with the work space of a solve.
struct CgBlock {
  const Vec3Array* b = nullptr;
  Vec3Array* x = nullptr;
  Vec3Array residual, preconditioned, direction, product;

  void begin();                                 // r = b, x = p = 0
  void turn(double beta, JobSystem& jobs);      // p = z + β p
  void advance(double alpha, JobSystem& jobs);  // x += α p, r −= α A p
};

/// Solves A x = b from x = 0 for all blocks together, with common α and β. multiply() computes product = A
/// direction in every block and returns p·q; precondition() computes preconditioned ≈ A⁻¹ residual and
/// returns r·z. Both work in a fixed order, so the result is bit-identical for any number of threads. Stops
/// early if A or the preconditioner turns out not to be positive definite.
template <class Multiply, class Precondition>
CgReport solve_conjugate_gradients(const Multiply& multiply, const Precondition& precondition,
                                   std::span<CgBlock* const> blocks, const CgSettings& settings,
                                   JobSystem& jobs) {
  for (CgBlock* block : blocks) block->begin();
  CgReport report;
  const double at_start = precondition();
  double rz = at_start, beta = 0;
  while (report.iterations < settings.iterations && rz > 0) {
    for (CgBlock* block : blocks) block->turn(beta, jobs);
    const double curvature = multiply();
    if (!(curvature > 0)) break;
    for (CgBlock* block : blocks) block->advance(rz / curvature, jobs);
    ++report.iterations;
    const double decrease = 0.5 * rz * rz / curvature;
    report.decrease += decrease;
    const bool is_enough = decrease < settings.enough * report.decrease;
    if (is_enough && report.iterations >= settings.least) break;
    if (report.iterations == settings.iterations) break;
    const double next = precondition();
    beta = next / rz;
    rz = next;
  }
  if (at_start > 0) report.residual = std::sqrt(std::max(rz, 0.0) / at_start);
  return report;
}

/// The same for one block: multiply(p, q) and precondition(r, z).
class ConjugateGradients {
 public:
  template <class Multiply, class Precondition>
  CgReport solve(const Multiply& multiply, const Precondition& precondition, const Vec3Array& b,
                 const CgSettings& settings, JobSystem& jobs, Vec3Array& x) {
    block_.b = &b;
    block_.x = &x;
    CgBlock* const blocks[] = {&block_};
    return solve_conjugate_gradients([&] { return multiply(block_.direction, block_.product); },
                                     [&] { return precondition(block_.residual, block_.preconditioned); },
                                     blocks, settings, jobs);
  }

 private:
  CgBlock block_;
};

}  // namespace weft::engine
