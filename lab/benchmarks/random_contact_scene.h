#pragma once
/// Random scenes for robustness tests of contact.

#include <cstdint>
#include <filesystem>

namespace weft::engine::lab {

/// Writes the scene seed_N.toml of a seed into the folder, with its meshes, and returns its file. One to six
/// cloths above each other, grids and irregular meshes, of springs and of fabrics, 0.3 to 4 mm thick, at up to
/// 3 m/s; some are pinned or carried along. One to five bodies below: planes, balls, capsules, boxes, rigid and
/// deforming meshes; most of them move and turn, and may squeeze cloth between each other. Nothing intersects
/// at the start, but bodies may intersect bodies. A seed gives the same scene everywhere, up to the rounding of sines.
std::filesystem::path write_random_contact_scene(const std::filesystem::path& folder, std::uint64_t seed);

}  // namespace weft::engine::lab
