#include "weft/face/build_cloth.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "weft/error.h"
#include "weft/face/build_rest.h"
#include "weft/face/build_seams.h"
#include "weft/face/convert.h"
#include "weft/mesh/clean.h"
#include "weft/model/fabric_springs.h"

namespace weft::engine {
namespace {

/// Edges shorter than this many thicknesses count as short: contact leaves position errors of up to 0.15 of a
/// thickness (kMaxShortfall of a gap), 8 % of such an edge, which step_check.h reports as a fault.
constexpr double kShortEdge = 2;  // [1]

/// The grid axis along warp, if any.
std::optional<GridWarp> grid_warp(const ClothDesc& desc) {
  constexpr double kAlong = 0.999999;  // minimum cosine of the angle between them
  const Vec3 direction = desc.warp ? to_engine(*desc.warp).normalized() : Vec3(Vec3::UnitX());
  if (std::abs(direction.x()) > kAlong) return GridWarp::first_axis;
  if (std::abs(direction.z()) > kAlong) return GridWarp::second_axis;
  return {};
}

/// What only meshes have; a grid with it is treated as one.
bool needs_mesh(const ClothDesc& desc) {
  if (const Fabric* fabric = std::get_if<Fabric>(&desc.fabric); fabric && fabric->strength > 0) return true;
  return !desc.seams.empty() || !desc.stitches.empty() || !desc.rest_scales.empty();
}

/// Throws InputError for springs with what only a fabric has.
void require_fabric(const ClothDesc& desc) {
  if (std::holds_alternative<Fabric>(desc.fabric)) return;
  if (!desc.rest_scales.empty())
    throw InputError("rest_scales follow warp and weft, which springs do not have; give it a fabric");
  if (std::holds_alternative<Grid>(desc.shape) && needs_mesh(desc))
    throw InputError("a grid of springs has no seams; give it a fabric");
}

/// Throws InputError for a strength where cloth does not tear.
void require_tearable(const ClothDesc& desc, const Fabric& fabric, const std::string& who) {
  if (fabric.strength == 0) return;
  if (desc.membrane == Membrane::springs)
    throw InputError(who + "springs do not tear; use membrane = \"triangle\", or strength = 0");
  if (has_bending_memory(fabric))
    throw InputError(who +
                     "cloth with hysteresis or set of bending does not tear; set "
                     "bend_hysteresis_warp, bend_hysteresis_weft and bend_set to 0, or strength");
}

CellDiagonals cell_diagonals(SpringModel model) {
  switch (model) {
    case SpringModel::basic:
      return CellDiagonals::both;
    case SpringModel::alternating:
      return CellDiagonals::alternating;
    case SpringModel::simplified:
      break;
  }
  return CellDiagonals::parallel;
}

/// Whether most of the rest surface is closer to vertical than to horizontal.
bool stands_upright(const TriangleMesh& mesh) {
  double upright = 0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 area = (mesh.positions[j] - mesh.positions[i]).cross(mesh.positions[k] - mesh.positions[i]);
    upright += area.norm() - std::sqrt(2.0) * std::abs(area.y());
  }
  return upright > 0;
}

/// Along the given direction, or by the texture coordinates of the triangles; without either, along the body in
/// garments.
WarpField find_warp(const ClothDesc& desc, const RestMesh& mesh, const std::vector<CornerUv>& uv,
                    const std::string& who, std::vector<std::string>& warnings) {
  std::optional<Vec3> direction;
  if (desc.warp) direction = to_engine(*desc.warp);
  if (!direction && std::holds_alternative<Grid>(desc.shape)) direction = Vec3::UnitX();
  if (!direction && uv.empty()) {
    const bool stands = stands_upright(mesh);
    direction = stands ? Vec3::UnitY() : Vec3::UnitX();
    warnings.push_back(who + "its mesh has no texture coordinates to define warp; it is set " +
                       (stands ? "upwards, warp = [0, 1, 0]" : "along x, warp = [1, 0, 0]"));
  }
  WarpField warp = direction ? warp_from_direction(mesh, *direction) : warp_from_uv(mesh, uv);
  if (warp.num_guessed == 0) return warp;
  warnings.push_back(
      who + (direction ? "warp is perpendicular to " : "texture coordinates do not define warp in ") +
      std::to_string(warp.num_guessed) + (warp.num_guessed == 1 ? " triangle" : " triangles") +
      ", which use another axis");
  return warp;
}

ClothMaterial make_material(const Springs& s) {
  return {.density = s.density,
          .structural = s.structural,
          .shear = s.shear,
          .bend = s.bend,
          .damping = s.damping,
          .damping_kind = s.damping_kind,
          .thickness = s.thickness,
          .friction = s.friction};
}

ClothMaterial make_material(const Fabric& f) {
  return {.density = f.density,
          .structural = 0,
          .shear = 0,
          .bend = 0,
          .thickness = f.thickness,
          .friction = f.friction};
}

ClothSubstance make_springs(const ClothDesc& desc, const Fabric& fabric, const RestShape& rest,
                            const std::string& who, std::vector<std::string>& warnings) {
  ClothMaterial material = make_material(fabric);
  const auto warn = [&](const std::vector<std::string>& messages) {
    for (const std::string& message : messages) warnings.push_back(who + message);
  };
  if (const Grid* grid = std::get_if<Grid>(&desc.shape); grid && !needs_mesh(desc)) {
    const std::optional<GridWarp> warp = grid_warp(desc);
    if (!warp)
      throw InputError(who +
                       "springs require warp along one of the grid's axes, "
                       "[1, 0, 0] or [0, 0, 1]; use membrane = \"triangle\" for other directions");
    const GridSprings springs =
        make_grid_springs(*grid, cell_diagonals(desc.model), *warp, fabric, desc.fabric_name);
    warn(springs.warnings);
    set_fabric_springs(springs, fabric, material);
    return {material, build_grid_bending_elements(*grid, *warp, fabric)};
  }
  const ClothTopology& topology = *rest.topology;
  const WarpField warp = find_warp(desc, topology.mesh, rest.uv, who, warnings);
  const MeshSprings springs = make_mesh_springs(topology.mesh, warp, fabric, desc.fabric_name);
  warn(springs.warnings);
  set_fabric_springs(springs, topology, fabric, material);
  return {material, build_mesh_bending_elements(topology.mesh, warp, fabric)};
}

ClothSubstance make_triangles(const ClothDesc& desc, const Fabric& fabric, const RestShape& rest,
                              const std::string& who, std::vector<std::string>& warnings) {
  const ClothTopology& topology = *rest.topology;
  ClothSubstance made{make_material(fabric), nullptr, nullptr};
  if (topology.grid) {
    if (fabric.strength > 0)
      throw InputError(who + "a grid that was added without strength does not tear; add it with one");
    made.elements = build_grid_elements(*topology.grid, topology.mesh, *grid_warp(desc), fabric);
    return made;
  }
  const WarpField warp = find_warp(desc, topology.mesh, rest.uv, who, warnings);
  made.elements = build_mesh_elements(topology.mesh, warp, fabric);
  if (fabric.strength > 0)
    made.tearing = std::make_shared<const TearingCloth>(TearingCloth{rest.topology, warp, fabric});
  return made;
}

/// At most half the mean edge length, so that few neighbours are nearer than the thickness.
double fit_thickness(double thickness, const RestMesh& mesh) {
  constexpr double kShareOfEdge = 0.5;
  const std::vector<Edge> edges = build_edges(mesh);
  double sum = 0;
  for (const Edge& e : edges) sum += edge_length(mesh, e);
  return std::min(thickness, kShareOfEdge * sum / static_cast<double>(edges.size()));
}

/// Multiplies lengths at rest by the factors of `desc`; notes.particle_of_vertex is known.
void apply_scales(const ClothDesc& desc, const std::vector<CornerUv>& uv,
                  const std::vector<AddedParticle>& added, const ClothNotes& notes, RestMesh& mesh) {
  if (desc.rest_scales.empty()) return;
  std::vector<std::string> known;  // build_substance() reports them
  scale_rest(desc.rest_scales, added, find_warp(desc, mesh, uv, "", known), notes, mesh);
}

RestShape build_from_grid(const ClothDesc& desc, const Grid& grid, ClothNotes& notes) {
  require_valid(grid);
  for (int i = 0; i < grid.num_particles(); ++i) notes.particle_of_vertex.push_back(i);
  if (!desc.rest.empty()) throw InputError("only the triangles of a mesh have another rest shape");
  const bool has_fabric = std::holds_alternative<Fabric>(desc.fabric);
  const bool is_turned = has_fabric && !grid_warp(desc);  // the kernels of grids require warp along an axis
  if (!is_turned && !needs_mesh(desc)) return {build_grid_topology(grid, desc.model), {}, {}};
  RestMesh mesh = build_grid_mesh(grid, diagonals_of(desc.model));
  apply_scales(desc, {}, {}, notes, mesh);
  report_rest(mesh, notes);
  Seams seams = build_seams(desc, mesh, notes);
  return {build_mesh_topology(std::move(mesh), std::move(seams)), {}, {}};
}

/// The given vertices at the corners of the cleaned triangles, -1: none. `mesh` is the given one.
std::vector<Triangle> find_vertices(const weft::TriangleMesh& mesh, const CleanMesh& clean) {
  std::vector<Triangle> vertices;
  for (std::size_t t = 0; t < clean.mesh.triangles.size(); ++t) {
    Triangle& own = vertices.emplace_back(Triangle{-1, -1, -1});
    const weft::Triangle& source = mesh.triangles[clean.source_triangle[t]];
    for (int corner = 0; corner < 3; ++corner) {
      for (int k = 0; k < 3; ++k) {
        if (clean.vertex_of_source[source[k]] == clean.mesh.triangles[t][corner]) own[corner] = source[k];
      }
    }
  }
  return vertices;
}

/// Particles without a vertex. `clean` has its triangles in the coordinates of those of `mesh`.
std::vector<AddedParticle> find_added(const weft::TriangleMesh& mesh, const CleanMesh& clean) {
  std::vector<char> is_known(clean.mesh.positions.size(), 0);
  for (const int particle : clean.vertex_of_source) {
    if (particle >= 0) is_known[particle] = 1;
  }
  std::vector<AddedParticle> added;
  for (std::size_t t = 0; t < clean.mesh.triangles.size(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const int particle = clean.mesh.triangles[t][corner];
      if (std::exchange(is_known[particle], 1)) continue;
      added.push_back({particle, mesh.triangles[clean.source_triangle[t]], clean.corner_weights[t][corner]});
    }
  }
  std::ranges::sort(added, {}, &AddedParticle::particle);
  return added;
}

RestShape build_from_mesh(const ClothDesc& desc, const weft::TriangleMesh& mesh, ClothNotes& notes) {
  if (!mesh.uv.empty() && mesh.uv.size() != mesh.triangles.size())
    throw InputError("its texture coordinates are of " + std::to_string(mesh.uv.size()) +
                     " triangles, but it has " + std::to_string(mesh.triangles.size()));
  const double thickness = std::visit([](const auto& fabric) { return fabric.thickness; }, desc.fabric);
  CleanMesh clean = clean_mesh(to_engine(mesh), {.weld_distance = desc.weld.value_or(-1),
                                                 .sew_distance = desc.sew,
                                                 .short_edge = kShortEdge * thickness});
  RestShape rest;
  const std::vector<CornerUv> uv = to_engine(mesh.uv);
  for (std::size_t t = 0; !uv.empty() && t < clean.source_triangle.size(); ++t)
    rest.uv.push_back(interpolate(uv[clean.source_triangle[t]], clean.corner_weights[t]));
  rest.added = find_added(mesh, clean);
  rest.vertices = find_vertices(mesh, clean);
  notes.particle_of_vertex = clean.vertex_of_source;
  notes.warnings = clean.warnings;
  notes.done = clean.notes;
  RestMesh prepared = clean.mesh;
  if (!desc.rest.empty()) {
    if (desc.rest.size() != mesh.triangles.size())
      throw InputError("its rest shape has " + std::to_string(desc.rest.size()) +
                       " triangles, but the mesh has " + std::to_string(mesh.triangles.size()));
    set_rest(desc.rest, clean, prepared, notes);
  }
  suggest_rest(prepared, rest.uv, notes);
  apply_scales(desc, rest.uv, rest.added, notes, prepared);
  report_rest(prepared, notes);
  Seams seams = build_seams(desc, prepared, notes);
  rest.topology = build_mesh_topology(std::move(prepared), std::move(seams));
  return rest;
}

}  // namespace

int find_particle(int vertex, const std::vector<int>& particle_of_vertex) {
  if (vertex < 0 || std::cmp_greater_equal(vertex, particle_of_vertex.size()))
    throw InputError("vertex " + std::to_string(vertex) + " is not one of the shape's " +
                     std::to_string(particle_of_vertex.size()));
  return particle_of_vertex[vertex];
}

RestShape build_rest_shape(const ClothDesc& desc, const std::string& who, ClothNotes& notes) {
  const std::string mesh_who =
      desc.source.empty() ? who : who.substr(0, who.size() - 2) + " (" + desc.source + "): ";
  const auto at_least_zero = [&](double value, const char* name, const char* unit) {
    if (!std::isfinite(value) || value < 0) throw InputError(who + name + " must be 0 " + unit + " or more");
  };
  at_least_zero(desc.weld.value_or(0), "weld", "m");
  at_least_zero(desc.sew, "sew", "m");
  at_least_zero(desc.seam_time, "seam_time", "s");
  at_least_zero(desc.seam_stiffness.value_or(0), "seam_stiffness", "N/m²");
  if (desc.warp && !(std::isfinite(length(*desc.warp)) && length(*desc.warp) > 0))
    throw InputError(who + "warp must be a direction, finite and not zero");
  try {
    require_fabric(desc);
    const Grid* grid = std::get_if<Grid>(&desc.shape);
    RestShape rest = grid ? build_from_grid(desc, *grid, notes)
                          : build_from_mesh(desc, std::get<weft::TriangleMesh>(desc.shape), notes);
    for (auto* list : {&notes.warnings, &notes.done}) {
      for (std::string& message : *list) message = mesh_who + message;
    }
    return rest;
  } catch (const InputError& error) {
    throw InputError(mesh_who + error.what());
  }
}

std::vector<Vec3> to_particles(const std::vector<Vec3>& of_vertices, const RestShape& rest,
                               const ClothNotes& notes) {
  const auto count = static_cast<std::size_t>(rest.topology->num_particles());
  std::vector<Vec3> result(count, Vec3::Zero());
  std::vector<int> num_vertices(count, 0);
  for (std::size_t v = 0; v < of_vertices.size(); ++v) {
    const int particle = notes.particle_of_vertex[v];
    if (particle < 0) continue;
    result[particle] += of_vertices[v];
    ++num_vertices[particle];
  }
  for (std::size_t i = 0; i < count; ++i) result[i] /= std::max(num_vertices[i], 1);
  for (const AddedParticle& added : rest.added) {
    for (int corner = 0; corner < 3; ++corner)
      result[added.particle] += added.weights[corner] * of_vertices[added.vertices[corner]];
  }
  return result;
}

ClothSubstance build_substance(const ClothDesc& desc, const RestShape& rest, const std::string& who,
                               std::vector<std::string>& warnings) {
  try {
    require_fabric(desc);
  } catch (const InputError& error) {
    throw InputError(who + error.what());
  }
  ClothSubstance made;
  if (const Fabric* fabric = std::get_if<Fabric>(&desc.fabric)) {
    validate_fabric(*fabric, desc.fabric_name);
    require_tearable(desc, *fabric, who);
    made = desc.membrane == Membrane::springs ? make_springs(desc, *fabric, rest, who, warnings)
                                              : make_triangles(desc, *fabric, rest, who, warnings);
  } else {
    made.material = make_material(std::get<Springs>(desc.fabric));
  }
  if (desc.fits_thickness)
    made.material.thickness = fit_thickness(made.material.thickness, rest.topology->mesh);
  return made;
}

void multiply_spring_factors(const ClothTopology& topology, const std::vector<int>& particles, double factor,
                             std::vector<double>& factors) {
  factors.resize(topology.springs.size(), 1.0);
  std::vector<char> is_inside(static_cast<std::size_t>(topology.num_particles()), 0);
  for (const int p : particles) is_inside[p] = 1;
  for (std::size_t s = 0; s < topology.springs.size(); ++s) {
    if (is_inside[topology.springs[s].i] && is_inside[topology.springs[s].j]) factors[s] *= factor;
  }
}

}  // namespace weft::engine
