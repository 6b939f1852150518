#pragma once
/// A fabric on a triangle mesh: warp directions, membranes, hinges.

#include <array>
#include <vector>

#include "weft/fabric.h"
#include "weft/mesh/rest_mesh.h"
#include "weft/mesh/rest_triangle.h"

namespace weft::engine {

/// Warp direction of each triangle; weft is perpendicular to it, in the triangle's plane.
struct WarpField {
  std::vector<Vec3> warp;  // unit vectors in the triangles' planes (num_triangles)
  int num_guessed = 0;     // triangles without a direction in the input: they got a fallback axis [1]
};

/// Warp along the gradient of u at constant v. Triangles with non-finite or degenerate uv use the world's x
/// axis as below.
WarpField warp_from_uv(const RestMesh& mesh, const std::vector<CornerUv>& uv);

/// From uv per vertex: u = uv[vertex].x().
WarpField warp_from_uv(const RestMesh& mesh, const std::vector<Vec2>& uv);

/// Warp along a direction, projected on every triangle; where that is perpendicular to the triangle, along
/// another axis.
WarpField warp_from_direction(const RestMesh& mesh, const Vec3& direction);

/// Multiplies lengths at rest along warp and weft by factors: of each triangle the mean of its corners' (num_vertices).
void scale_rest(RestMesh& mesh, const WarpField& warp, const std::vector<Vec2>& factors);

/// [C11 C12 0; C12 C22 0; 0 0 G] for forces/membrane.h [N/m].
Mat3 membrane_stiffness(const Fabric& fabric);

struct MembraneElement {
  Triangle vertices;
  RestTriangle rest;
};

/// One per triangle, in its order; `warp` only rotates the frame.
std::vector<MembraneElement> build_membranes(const RestMesh& mesh, const WarpField& warp);

/// One triangle, or two with a common edge, which resist their mean strain (forces/membrane_patch.h).
///
///          2
///         / \\        0, 1, 2: corners of the first triangle; 3: the other corner of the second one.
///        0---1       `corners` numbers the corners of each triangle, in its own order, in this way.
///         \\ /
///          3
struct MembranePatch {
  int num_triangles = 1;
  std::array<int, 4> vertices = {-1, -1, -1, -1};
  std::array<int, 2> triangles = {-1, -1};  // indices of membranes
  std::array<std::array<int, 3>, 2> corners = {};
  std::array<RestTriangle, 2> rest = {};

  int num_vertices() const { return num_triangles + 2; }
  double area() const { return rest[0].area + rest[1].area; }  // [m²]
};

/// Every triangle alone.
std::vector<MembranePatch> make_single_patches(const std::vector<MembraneElement>& membranes);

/// Pairs of triangles, as nearly square as they can be, and triangles that have no partner. Only triangles with
/// the same orientation and nearly the same warp direction are paired. Every triangle is in one patch.
std::vector<MembranePatch> pair_triangles(const RestMesh& mesh, const WarpField& warp,
                                          const std::vector<MembraneElement>& membranes);

struct HingeElement {
  std::array<int, 4> vertices;   // as in forces/hinge.h: the edge's ends, then the two opposite ones
  std::array<int, 2> triangles;  // of the two opposite vertices
  double stiffness = 0;          // k [N·m]
};

/// One per edge between two triangles. k = D |e|²/(A0 + A1), D the rigidity of bending across the edge:
/// bending_rigidity() in the direction perpendicular to it, so a hinge along weft threads bends warp. Exact
/// for cylinders around rows of parallel edges, but up to three times too stiff for the diagonals of a grid,
/// whose hinges add to the others. BendingRows avoids that error.
std::vector<HingeElement> build_hinges(const RestMesh& mesh, const WarpField& warp, const Fabric& fabric);

}  // namespace weft::engine
