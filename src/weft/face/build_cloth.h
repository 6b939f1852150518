#pragma once
/// Converts a ClothDesc to the engine's topology, material and elements: mesh cleaning, warp direction,
/// elements or springs, thickness.

#include <memory>
#include <string>
#include <vector>

#include "weft/cloth.h"
#include "weft/model/cloth_model.h"
#include "weft/model/torn_cloth.h"

namespace weft::engine {

/// A particle that is no vertex of the given mesh: sewing has added it within a triangle.
struct AddedParticle {
  int particle = 0;
  Triangle vertices = {};        // of the given mesh, its corners
  Vec3 weights = Vec3::UnitX();  // of these, at rest; sum 1 [1]
};

/// Rest shape of a cloth.
struct RestShape {
  std::shared_ptr<const ClothTopology> topology;
  std::vector<CornerUv> uv;          // of the topology's triangles; empty: none
  std::vector<AddedParticle> added;  // by ascending particle
  std::vector<Triangle> vertices;    // (triangles) given vertices at their corners, -1: of an added particle;
                                     // empty of a grid, whose particles are its vertices
};

/// The particle of a vertex of the given mesh, -1: dropped with the triangles around it. Throws InputError for a
/// vertex that is not there.
int find_particle(int vertex, const std::vector<int>& particle_of_vertex);

/// Cleans and sews a mesh as `desc` says; `notes` receives the report. Throws InputError, beginning with
/// `who`, for an invalid cloth mesh.
RestShape build_rest_shape(const ClothDesc& desc, const std::string& who, ClothNotes& notes);

/// Positions or velocities of the particles from those of the given mesh's vertices. Sewn vertices have their
/// mean, an added particle has the weighted mean of its triangle's corners.
std::vector<Vec3> to_particles(const std::vector<Vec3>& of_vertices, const RestShape& rest,
                               const ClothNotes& notes);

struct ClothSubstance {
  ClothMaterial material;
  std::shared_ptr<const ClothElements> elements;  // null: springs only
  std::shared_ptr<const TearingCloth> tearing;    // of a fabric with a strength
};

/// Throws InputError, beginning with `who`, for an invalid fabric.
ClothSubstance build_substance(const ClothDesc& desc, const RestShape& rest, const std::string& who,
                               std::vector<std::string>& warnings);

/// Multiplies the factors of springs with both ends among the particles; an empty list counts as all 1.
void multiply_spring_factors(const ClothTopology& topology, const std::vector<int>& particles, double factor,
                             std::vector<double>& factors);

}  // namespace weft::engine
