#pragma once
/// Converts the seams and stitches of a ClothDesc to springs between particles.

#include "weft/cloth.h"
#include "weft/mesh/rest_mesh.h"
#include "weft/model/seams.h"

namespace weft::engine {

/// `mesh` is that of the particles, of which `notes` has those of the vertices; it receives the report. Throws
/// InputError for vertices that are not there, or not on a border.
Seams build_seams(const ClothDesc& desc, const RestMesh& mesh, ClothNotes& notes);

}  // namespace weft::engine
