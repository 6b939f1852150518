#include "weft/contact/repair_input.h"

#include <algorithm>

namespace weft::engine {

RepairInput make_repair_input(const StepBodies& bodies) {
  const Numbering& numbering = bodies.numbering;
  RepairInput input{.surface = bodies.surface,
                    .first_vertex = numbering.first_vertex,
                    .num_cloth_vertices = numbering.num_cloth_vertices(),
                    .inverse_mass = &bodies.inverse_mass,
                    .half_thickness = &bodies.motion.half_thickness};
  input.non_colliding = [&bodies](int v, int w) {
    const Numbering& of = bodies.numbering;
    return !bodies.pairs.of(of.place_of(std::min(v, w)), of.place_of(std::max(v, w))).collide;
  };
  input.non_colliding_solid = [&bodies](int v, int collider) {
    return !bodies.pairs.of(bodies.numbering.place_of(v), {.collider = collider}).collide;
  };
  for (const ContactCloth& cloth : bodies.cloths) {
    const TriangleMesh& mesh = cloth.model->topology->mesh;
    input.num_cloth_triangles += mesh.num_triangles();
    input.rest.insert(input.rest.end(), mesh.positions.begin(), mesh.positions.end());
    input.layers.push_back(cloth.layer);
    input.origins.insert(input.origins.end(), mesh.positions.size(), cloth.state->origin);
  }
  const std::vector<MovingShape>& shapes = bodies.shapes;
  for (int s = 0; s < static_cast<int>(shapes.size()); ++s) {
    if (!shapes[s].is_mesh()) input.solids.push_back({s, shapes[s].after});
  }
  for (const ColliderMesh& body : numbering.bodies) {
    input.first_vertex.push_back(body.end_vertex);
    if (!body.solid.empty())
      input.solids.push_back(
          {body.collider, shapes[body.collider].after, body.first_vertex, body.end_vertex, body.solid});
  }
  return input;
}

std::vector<Vec3> positions_now(const StepBodies& bodies) {
  std::vector<Vec3> positions = bodies.motion.end;
  std::copy_n(bodies.motion.start.begin(), bodies.num_cloth_vertices(), positions.begin());
  return positions;
}

}  // namespace weft::engine
