#pragma once
/// Resistance of a triangle to collapse: shear locking, and a minimum width of crumpled cells.
///
///     W = A [ψ(σ1) + ψ(σ2)]           σ1 >= σ2: principal stretches of F (forces/membrane.h) [1]
///
///     ψ |`.
///       |  `.   ψ'' = k               ψ is 0 for σ >= 0.5, a cubic down to σ = 0.3 and a parabola below:
///       |    `._                      limit_response() of the narrowing 1 − σ. C², convex, finite at 0.
///       |_______`--.________ σ
///       0      0.3  0.5    1
///
/// One function covers every collapse, because each takes σ2 to 0: threads of constant length sheared by γ
/// have σ2 = √(1 − sin γ), a thread compressed to half its length has 0.5, three collinear corners have 0.
///
/// Shear locking: sheared woven fabric stiffens where adjacent yarns touch (A. G. Prodromou, J. Chen, On the
/// relationship between shear angle and wrinkling of textile composite preforms, Composites A 28, 1997). The
/// onset of ψ at 48.6° and its full stiffness from 65.5° are our choice, not a measurement. Compression: the
/// tension of Green strain is greatest at σ = 1/√3 and vanishes at σ = 0; ψ replaces it there. Lower and
/// upper bounds of principal stretches: H. Wang, J. O'Brien, R. Ramamoorthi, Multi-Resolution Isotropic
/// Strain Limiting, ACM TOG 29(6), 2010. k is the mean tensile stiffness of the cloth.
///
/// At σ2 = 0 the gradient's direction is undefined: the triangle then opens to a side that depends only on
/// its longer axis, the same for all triangles on one line.
///
/// All functions take the corners' positions [m].

#include <array>
#include <memory>

#include "weft/forces/membrane.h"
#include "weft/forces/term.h"
#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

inline constexpr double kCollapseBegin = 0.5;  // principal stretch below which ψ > 0 [1]
inline constexpr double kCollapseFull = 0.3;   // principal stretch below which ψ'' = k [1]

/// ψ as a limit of the narrowing 1 − σ. k is the mean of C11 and C22 of membranes, plus the mean stiffness of
/// the structural springs [N/m].
StrainLimit make_collapse_law(const ClothModel& model);

/// W [J].
double collapse_energy(const RestTriangle& rest, const StrainLimit& law, const TriangleCorners& x);

/// Force on each corner: −∂W/∂x [N]. Forces and their moments sum to zero.
TriangleCorners collapse_force(const RestTriangle& rest, const StrainLimit& law, const TriangleCorners& x);

/// Along a principal axis: ψ of the narrowing 1 − σ, and the derivative of the narrowing at each corner [1/m].
struct CollapseAxis {
  LimitResponse response;
  TriangleCorners gradient;
};
/// Both axes; without response where the triangle is wide.
std::array<CollapseAxis, 2> collapse_axes(const RestTriangle& rest, const StrainLimit& law,
                                          const TriangleCorners& x);

/// ∂²W/∂x² = Σ_m stiffness_m w_m w_mᵀ with the closed-form eigenvectors of an isotropic energy (B. Smith, F.
/// de Goes, T. Kim, Analytic Eigensystems for Isotropic Distortion Energies, ACM TOG 38(1), 2019): w_m has
/// one vector per corner. The w_m are orthogonal as functions of F, and no stiffness exceeds A k: the Hessian
/// is bounded by k times the cotangent Laplacian, which preconditioners already contain.
struct CollapseHessian {
  static constexpr int kMaxModes = 6;

  int num_modes = 0;                               // of nonzero stiffness
  std::array<double, kMaxModes> stiffness{};       // [N·m]
  std::array<TriangleCorners, kMaxModes> corners;  // [1/m]
};

/// The SPD projection drops the modes of negative stiffness, the buckling modes of compression.
CollapseHessian collapse_hessian(const RestTriangle& rest, const StrainLimit& law, const TriangleCorners& x,
                                 HessianKind kind);

/// The 3×3 block of corners a and b [N/m].
Mat3 collapse_block(const CollapseHessian& hessian, int a, int b);

/// Of all triangles; null if k is zero.
std::unique_ptr<Term> make_collapse_term(const ClothModel& model, const ClothState& state);

}  // namespace weft::engine
