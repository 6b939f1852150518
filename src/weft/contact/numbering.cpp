#include "weft/contact/numbering.h"

#include <algorithm>
#include <limits>

#include "weft/mesh/solid.h"

namespace weft::engine {
namespace {

std::vector<RestEdges> measure_edges(const Numbering& numbering, const Surface& surface,
                                     const std::vector<Vec3>& rest) {
  std::vector<RestEdges> edges(numbering.num_cloths());
  std::vector<int> count(edges.size(), 0);
  for (const auto& [i, j] : surface.edges) {
    if (!numbering.is_of_cloth(i)) break;
    const int cloth = numbering.cloth_of(i);
    const double length = (rest[j] - rest[i]).norm();
    edges[cloth].longest = std::max(edges[cloth].longest, length);
    edges[cloth].mean += length;
    ++count[cloth];
  }
  for (std::size_t c = 0; c < edges.size(); ++c) edges[c].mean /= std::max(count[c], 1);
  return edges;
}

/// Squared radius of the triangle's minimal enclosing circle [m²].
double enclosing_radius_sq(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double ab = (b - a).squaredNorm(), bc = (c - b).squaredNorm(), ca = (a - c).squaredNorm();
  const double longest = std::max({ab, bc, ca});
  if (2 * longest >= ab + bc + ca) return longest / 4;  // right-angled or obtuse
  return ab * bc * ca / (4 * (b - a).cross(c - a).squaredNorm());
}

std::vector<double> measure_circles(const Numbering& numbering) {
  std::vector<double> largest(numbering.num_cloth_vertices(), 0.0);
  for (int cloth = 0; cloth < numbering.num_cloths(); ++cloth) {
    const RestMesh& mesh = numbering.topologies[cloth]->mesh;
    double* const largest_at = largest.data() + numbering.first_vertex[cloth];
    for (int t = 0; t < mesh.num_triangles(); ++t) {
      const auto [a, b, c] = mesh.corners(t);
      const double radius_sq = enclosing_radius_sq(a, b, c);
      for (const int v : mesh.triangles[t]) largest_at[v] = std::max(largest_at[v], radius_sq);
    }
  }
  return largest;
}

ColliderMesh add_body(int collider, const TriangleMesh& mesh, Surface& surface) {
  ColliderMesh body{.collider = collider,
                    .first_vertex = surface.num_vertices,
                    .first_triangle = static_cast<int>(surface.triangles.size()),
                    .solid = find_solid_part(mesh).triangles,
                    .is_solid = std::vector<char>(mesh.positions.size(), 0)};
  for (Triangle& t : body.solid) {
    for (int& v : t) {
      body.is_solid[v] = 1;
      v += body.first_vertex;
    }
  }
  body.min = body.max = mesh.positions[0];
  for (const Vec3& p : mesh.positions) {
    body.min = body.min.cwiseMin(p);
    body.max = body.max.cwiseMax(p);
  }
  surface.add(mesh.triangles, mesh.num_vertices());
  body.end_vertex = surface.num_vertices;
  body.end_triangle = static_cast<int>(surface.triangles.size());
  return body;
}

}  // namespace

std::pair<Vec3, Vec3> ColliderMesh::bounds_at(const MeshShape& shape) const {
  const Vec3 middle = shape.rotation * (0.5 * (min + max)) + shape.translation;
  Vec3 half = shape.rotation.cwiseAbs() * (0.5 * (max - min));
  if (shape.source) half.setConstant(std::numeric_limits<double>::infinity());
  return {middle - half, middle + half};
}

const ColliderMesh& Numbering::body_of(int vertex) const {
  return *std::find_if(bodies.begin(), bodies.end(),
                       [&](const ColliderMesh& b) { return vertex < b.end_vertex; });
}

const ColliderMesh& Numbering::body_with(int collider) const {
  return *std::find_if(bodies.begin(), bodies.end(),
                       [&](const ColliderMesh& b) { return b.collider == collider; });
}

BodyPlace Numbering::place_of(int vertex) const {
  if (!is_of_cloth(vertex)) {
    const ColliderMesh& body = body_of(vertex);
    return {.collider = body.collider, .index = vertex - body.first_vertex};
  }
  const int cloth = cloth_of(vertex);
  return {.cloth = cloth, .index = vertex - first_vertex[cloth]};
}

BodyPlace Numbering::place_of_triangle(const Surface& surface, int triangle) const {
  BodyPlace place = place_of(surface.triangles[triangle][0]);
  if (place.collider >= 0) {
    place.index = triangle - body_with(place.collider).first_triangle;
    return place;
  }
  place.index = triangle;
  for (int c = 0; c < place.cloth; ++c) place.index -= topologies[c]->mesh.num_triangles();
  return place;
}

bool Numbering::holds_for(std::span<const ContactCloth> cloths,
                          const std::vector<Collider>& colliders) const {
  if (first_vertex.empty()) return false;
  const auto same_cloth = [](const ContactCloth& c, const auto& topology) {
    return c.model->topology == topology;
  };
  if (!std::equal(cloths.begin(), cloths.end(), topologies.begin(), topologies.end(), same_cloth))
    return false;
  std::size_t num_meshes = 0;
  for (const Collider& c : colliders) {
    const MeshShape* shape = std::get_if<MeshShape>(&c.shape);
    if (!shape) continue;
    if (num_meshes == meshes.size() || shape->mesh != meshes[num_meshes++]) return false;
  }
  return num_meshes == meshes.size();
}

Numbering number_bodies(std::span<const ContactCloth> cloths, const std::vector<Collider>& colliders,
                        Surface& surface, std::vector<Vec3>& rest) {
  Numbering numbering;
  for (const ContactCloth& cloth : cloths) {
    const TriangleMesh& mesh = cloth.model->topology->mesh;
    numbering.topologies.push_back(cloth.model->topology);
    numbering.first_vertex.push_back(surface.num_vertices);
    surface.add(mesh.triangles, mesh.num_vertices());
    rest.insert(rest.end(), mesh.positions.begin(), mesh.positions.end());
  }
  numbering.first_vertex.push_back(surface.num_vertices);
  for (int c = 0; c < static_cast<int>(colliders.size()); ++c) {
    const MeshShape* shape = std::get_if<MeshShape>(&colliders[c].shape);
    if (!shape) continue;
    numbering.meshes.push_back(shape->mesh);
    numbering.bodies.push_back(add_body(c, *shape->mesh, surface));
  }
  surface.build_one_rings();
  numbering.rest_edges = measure_edges(numbering, surface, rest);
  numbering.rest_circle_sq = measure_circles(numbering);
  return numbering;
}

}  // namespace weft::engine
