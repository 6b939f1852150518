#pragma once
/// A triangle's flat rest shape in the frame of the cloth: axis 1 along warp, axis 2 along weft.

#include <array>

#include "weft/mesh/rest_mesh.h"

namespace weft::engine {

using Vec2 = Eigen::Vector2d;

/// Rest data of a linear triangle element. With X its corners in the plane, corner c's shape function rises
/// from 0 on the opposite edge to 1 at c, and `gradient[c]` is its gradient:
///
///          2                 Any field that is linear over the triangle has the gradient
///         / \                Σ_c value_c gradient[c]. The three gradients sum to zero.
///        /   \               |gradient[c]| = 1 / (height over the edge opposite to c)
///       0-----1
struct RestTriangle {
  double area = 0;               // > 0 [m²]
  std::array<Vec2, 3> gradient;  // [1/m]
};

/// From corners in the plane, in either orientation [m]. The triangle's area must not be zero.
RestTriangle make_rest_triangle(const Vec2& x0, const Vec2& x1, const Vec2& x2);

/// Triangle t at rest, with axis 1 along its first edge instead of warp: for isotropic quantities.
RestTriangle make_rest_triangle(const RestMesh& mesh, int t);

}  // namespace weft::engine
