#pragma once
/// `weft study peers`: the same cloth in other engines.

#include "lab/report/sections.h"

namespace weft::engine::lab {

/// Bullet where it was there when Weft was built; MuJoCo and Newton through Python where they are installed
/// ($WEFT_PYTHON, else python3); Blender's cloth where Blender is ($WEFT_BLENDER, else blender). What is
/// missing is said in its row.
Section study_peers(const SectionOptions& options);

}  // namespace weft::engine::lab
