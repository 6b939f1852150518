#pragma once
/// Stretching and shearing of a triangle: the St. Venant–Kirchhoff (StVK) membrane.
///
///            x2                 F = Σ_c x_c g_cᵀ, 3×2: deformation gradient     g_c: RestTriangle::gradient
///           /  \                e = (ε11, ε22, 2 ε12) of ε = ½ (Fᵀ F − I)     Green strain
///     weft /    \               s = C e, C = [C11 C12 0; C12 C22 0; 0 0 G]    tensions [N/m]
///      ↑  /      \              W = A ½ eᵀ C e,  S = [s1 s3; s3 s2]
///       x0 ------ x1
///          → warp
///
/// Green strain is linear in the three squared edge lengths, so this is a network of quartic springs (H.
/// Delingette, Triangular Springs for Modeling Nonlinear Membranes, IEEE TVCG 14(2), 2008, is the isotropic
/// case); it is zero for every rigid motion. A strip of constant width, stretched along warp to λ times its
/// length, pulls with C11 λ (λ² − 1)/2 per width: C11 at small strain, progressively more beyond.
///
/// All functions take the corners' positions [m].

#include <array>

#include "weft/core/vec.h"
#include "weft/fabric/membrane_law.h"
#include "weft/mesh/rest_triangle.h"

namespace weft::engine {

/// Green strain (ε11, ε22, 2 ε12) [1].
Vec3 membrane_strain(const RestTriangle& rest, const TriangleCorners& x);

/// ∂e/∂x_c of each corner: three rows, (ε11, ε22, 2 ε12) [1/m].
std::array<Mat3, 3> membrane_strain_derivative(const RestTriangle& rest, const TriangleCorners& x);

/// Smallest and largest stretch over all directions in the triangle: length over rest length [1].
std::array<double, 2> principal_stretches(const RestTriangle& rest, const TriangleCorners& x);

/// Force on each corner by a stress: f_c = −A F S g_c [N]. Forces and their moments sum to zero.
TriangleCorners stress_force(const RestTriangle& rest, const Vec3& stress, const TriangleCorners& x);

/// Second derivatives of A s·e at constant stress are the Laplacian of three scalar zero-length springs, along
/// the edges opposite to corners 0, 1, 2: w_ab = −A g_a·S g_b, maybe negative [N/m].
std::array<double, 3> stress_weights(const RestTriangle& rest, const Vec3& stress);

enum class StressFilter {
  exact,     // the true Hessian: indefinite where the triangle is compressed
  absolute,  // |w_ab|: positive semidefinite, and stable where the linear system is solved accurately
};

/// Their block of corners a and b: this number times the identity [N/m].
double stress_block(const std::array<double, 3>& weights, int a, int b, StressFilter filter);

}  // namespace weft::engine
