#include "lab/paper/paper_hypotheses.h"

namespace weft::engine::lab {

Section study_paper(const SectionOptions& options) {
  Section section{
      .name = "paper",
      .title = "The paper's claims",
      .introduction =
          "*Cloth Simulation Based on Simplified Mass-Spring Model* replaces the two shear springs of each "
          "cell by one. It replaces the linear system of implicit integration by one formula, its Eq. 16. It "
          "prints no numbers. This section measures each of its claims, then its errata. Unless stated "
          "otherwise the cloth is a sheet of a square metre, 0.2 kg/m², with structural springs of 2000 N/m. "
          "It hangs from two corners and is released from horizontal."};
  using namespace paper;
  section.hypotheses = {one_shear_spring(options), large_steps(options),  faster_than_implicit(options),
                        linear_cost(options),      real_time(options),    parameters_change_freely(),
                        figures_remade(options),   gravity_is_filtered(), no_damping_of_its_own(),
                        damping_feeds_motion()};
  return section;
}

}  // namespace weft::engine::lab
