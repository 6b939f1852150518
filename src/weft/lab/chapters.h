#pragma once
/// The chapters of the study: each tests the claims of one subject and tells what came out. Whoever runs them
/// fills in version, is_quick and seconds.

#include <functional>
#include <memory>

#include "weft/io/animation.h"
#include "weft/lab/chapter.h"
#include "weft/model/cloth_model.h"

namespace weft::engine {

struct ChapterOptions {
  bool quick = false;                           // smaller cloths, fewer settings: seconds instead of minutes
  int threads = 1;                              // of simulations that are not timed [1]
  std::filesystem::path cache;                  // for references; empty: default_cache_folder()
  std::function<void(const std::string&)> say;  // told what is being done; may be empty
  /// Paints frames of an animation, side by side, into a file of the report's folder; its first cloth as
  /// springs, from above, if a topology is given. Empty: no pictures.
  std::function<void(const std::string& file, const Animation& animation, const std::vector<int>& frames,
                     std::shared_ptr<const ClothTopology> springs)>
      paint;

  void tell(const std::string& what) const {
    if (say) say(what);
  }
};

/// What the paper claims, and what it does not say.
Chapter study_paper(const ChapterOptions& options);

/// How right every integrator is, for how much time; convergence, energy, frequencies.
Chapter study_accuracy(const ChapterOptions& options);

/// What contact holds, and at what cost.
Chapter study_contact(const ChapterOptions& options);

/// One fabric on many meshes and at many steps.
Chapter study_fabric(const ChapterOptions& options);

}  // namespace weft::engine
