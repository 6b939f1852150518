#pragma once
/// `weft study peers`: the same cloth in other engines.

#include "weft/lab/chapters.h"

namespace weft::engine::bench {

/// Bullet where it was there when Weft was built; MuJoCo and Newton through Python where they are installed
/// ($WEFT_PYTHON, else python3); Blender's cloth where Blender is ($WEFT_BLENDER, else blender). What is
/// missing is said in its row.
Chapter study_peers(const ChapterOptions& options);

}  // namespace weft::engine::bench
