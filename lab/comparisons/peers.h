#pragma once
/// `weft study peers`: the same cloth in other engines.

#include "lab/report/sections.h"

namespace weft::engine::lab {

/// Bullet if Weft was built with it. MuJoCo and Newton through Python if installed ($WEFT_PYTHON, else
/// python3); Blender's cloth if Blender is installed ($WEFT_BLENDER, else blender). A missing engine has a
/// row that says so.
Section study_peers(const SectionOptions& options);

}  // namespace weft::engine::lab
