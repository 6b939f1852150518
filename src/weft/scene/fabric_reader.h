#pragma once
/// Reader for fabric files (TOML), reports every mistake with line and column. Fabrics by name or file.
///
///     density   = 0.324      # mass per area [kg/m²]
///     c11       = 410.7      # stretching along warp [N/m]
///     c22       = 2027.8     # along weft [N/m]
///     c12       = 20.5       # coupling of warp and weft [N/m]
///     g         = 53.4       # shearing [N/m]
///     bend_warp = 16.05e-6   # bending along warp [N·m]
///     bend_weft = 24.24e-6   # along weft [N·m]
///     bend_bias = 18.35e-6   # along the bias, at 45° [N·m]
///     damping   = 0.002      # time constant of internal damping, optional [s]
///     thickness = 0.0008     # optional [m]
///     friction  = 0.5        # of the fabric on itself, optional [1]
///
/// Also optional: `bend_hysteresis_warp`, `bend_hysteresis_weft`, `bend_set`, `strain_limit`, `strength` and the curves `stretch_warp` and `stretch_weft` ([[strain, tension], …]).
/// Fabric documents each number and its default.

#include <filesystem>
#include <string>
#include <string_view>

#include "weft/fabric.h"
#include "weft/scene.h"

namespace weft::engine {

/// Reads and validates a fabric file; the fabric is named for the file. Throws SceneError with every mistake.
FabricPreset read_fabric_file(const std::filesystem::path& file);

/// The same from text; `file` is used in messages and for the name.
FabricPreset parse_fabric(std::string_view text, const std::filesystem::path& file);

/// The fabric of an existing file (relative to `folder`) or of a preset, as a user typed it. Throws
/// InputError with the nearest preset name.
FabricPreset load_fabric(const std::string& name_or_file, const std::filesystem::path& folder = {});

}  // namespace weft::engine
