#pragma once
/// The sections of the study: each tests the hypotheses of one subject and returns the results. The caller
/// fills in version, is_quick and seconds.

#include <functional>
#include <memory>

#include "lab/report/report.h"
#include "weft/io/animation.h"
#include "weft/model/cloth_model.h"

namespace weft::engine::lab {

struct SectionOptions {
  bool quick = false;                           // smaller cloths, fewer settings: seconds instead of minutes
  int threads = 1;                              // of simulations that are not timed [1]
  std::filesystem::path cache;                  // for references; empty: default_cache_folder()
  std::function<void(const std::string&)> say;  // progress messages; may be empty
  /// Draws frames of an animation, in a row, to a file of the report's folder. With a topology, the first
  /// cloth is drawn as springs, from above. Empty: no pictures.
  std::function<void(const std::string& file, const Animation& animation, const std::vector<int>& frames,
                     std::shared_ptr<const ClothTopology> springs)>
      paint;

  void report_progress(const std::string& what) const {
    if (say) say(what);
  }
};

/// The claims of the paper, and its errata.
Section study_paper(const SectionOptions& options);

/// Error against time of every integrator; convergence, energy, frequencies.
Section study_accuracy(const SectionOptions& options);

/// Accuracy and cost of contact.
Section study_contact(const SectionOptions& options);

/// One fabric on many meshes and at many steps.
Section study_fabric(const SectionOptions& options);

}  // namespace weft::engine::lab
