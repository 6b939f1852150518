#pragma once
/// Private to lab/: the hypotheses of `weft study paper`, in the order of the section.

#include "lab/report/sections.h"

namespace weft::engine::lab::paper {

Hypothesis one_shear_spring(const SectionOptions& options);
Hypothesis large_steps(const SectionOptions& options);
Hypothesis faster_than_implicit(const SectionOptions& options);
Hypothesis linear_cost(const SectionOptions& options);
Hypothesis real_time(const SectionOptions& options);
Hypothesis parameters_change_freely();
Hypothesis figures_remade(const SectionOptions& options);

Hypothesis gravity_is_filtered();
Hypothesis no_damping_of_its_own();
Hypothesis damping_feeds_motion();

}  // namespace weft::engine::lab::paper
