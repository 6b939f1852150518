#pragma once
/// Gives a cloth's mesh the rest shape of a ClothDesc.

#include <vector>

#include "weft/cloth.h"
#include "weft/fabric/elements.h"
#include "weft/face/build_cloth.h"
#include "weft/mesh/clean.h"
#include "weft/mesh/rest_mesh.h"

namespace weft::engine {

/// Gives a cleaned mesh the triangles at rest of the given one, one for each of its triangles.
void set_rest(const std::vector<weft::TriangleCorners>& given, const CleanMesh& clean, RestMesh& mesh,
              ClothNotes& notes);

/// Multiplies lengths at rest by the factors of the parts of a cloth; `notes` has the particles of the vertices.
/// `added` are particles without a vertex. Throws InputError for factors and vertices that cannot be.
void scale_rest(const std::vector<RestScale>& scales, const std::vector<AddedParticle>& added,
                const WarpField& warp, const ClothNotes& notes, RestMesh& mesh);

/// Reports how long edges are at the start, by their length at rest.
void report_rest(const RestMesh& mesh, ClothNotes& notes);

/// Reports texture coordinates that look like the pattern of a mesh without a rest shape.
void suggest_rest(const RestMesh& mesh, const std::vector<CornerUv>& uv, ClothNotes& notes);

}  // namespace weft::engine
