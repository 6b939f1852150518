#pragma once
/// `weft study peers`: the same cloth in other engines.

#include "weft/lab/chapters.h"

namespace weft::bench {

/// Bullet where it was there when Weft was built; MuJoCo through Python where it is installed ($WEFT_PYTHON,
/// else python3). What is missing is said in its row.
Chapter study_peers(const ChapterOptions& options);

}  // namespace weft::bench
