#pragma once
/// Private to lab/: the claims of `weft study paper`, in the order of its chapter.

#include "weft/lab/chapters.h"

namespace weft::engine::paper_study {

Claim one_shear_spring(const ChapterOptions& options);
Claim large_steps(const ChapterOptions& options);
Claim faster_than_implicit(const ChapterOptions& options);
Claim linear_cost(const ChapterOptions& options);
Claim real_time(const ChapterOptions& options);
Claim parameters_change_freely();
Claim figures_remade(const ChapterOptions& options);

Claim gravity_is_filtered();
Claim no_damping_of_its_own();
Claim damping_feeds_motion();

}  // namespace weft::engine::paper_study
