#include "lab/paper/paper_hypotheses.h"

namespace weft::engine::lab {

Section study_paper(const SectionOptions& options) {
  Section section{
      .name = "paper",
      .title = "The paper's claims",
      .introduction =
          "*Cloth Simulation Based on Simplified Mass-Spring Model* replaces the two shear springs of each "
          "cell by one, and the linear system of implicit integration by one formula, its Eq. 16. It prints "
          "no numbers. Here each of its claims is measured, and then what it does not say. Unless told "
          "otherwise the cloth is a sheet of a square metre, 0.2 kg/m², with structural springs of 2000 N/m, "
          "hung by two corners and let go from horizontal."};
  using namespace paper;
  section.hypotheses = {one_shear_spring(options), large_steps(options),  faster_than_implicit(options),
                        linear_cost(options),      real_time(options),    parameters_change_freely(),
                        figures_remade(options),   gravity_is_filtered(), no_damping_of_its_own(),
                        damping_feeds_motion()};
  return section;
}

}  // namespace weft::engine::lab
