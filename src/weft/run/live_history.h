#pragma once
/// The last seconds of a live simulation: every tenth step is kept, the steps between are repeated. With the
/// changes that a person made between the same steps they have the same bits.

#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "weft/run/live_values.h"
#include "weft/scene/scene_desc.h"
#include "weft/world.h"

namespace weft::engine {

/// A state between two steps from which all later ones can be repeated.
struct LiveMoment {
  std::int64_t steps = 0;  // made before it [1]
  double time = 0;         // [s]
  weft::Snapshot state;
  std::shared_ptr<const SceneDesc> scene;  // that the next step had
  std::optional<ClothPoint> held;          // the grab, likewise
};

class LiveHistory {
 public:
  static constexpr int kSpacing = 10;               // steps between moments [1]
  static constexpr double kSpan = 10;               // of the steps that can be repeated [s]
  static constexpr double kMaxBytes = 256e6;        // of all moments
  static constexpr double kBytesPerParticle = 160;  // of a moment: states, with room for pins and forces

  /// Whether a moment is wanted after so many steps.
  bool wants(std::int64_t steps) const;

  /// Drops moments older than the span, and those beyond the memory.
  void add(LiveMoment moment, std::size_t num_particles);

  /// A change by the user before the next step; it is repeated with it.
  void add_change(std::int64_t steps, std::function<void()> change);

  /// Drops all after so many steps: other steps follow.
  void forget_after(std::int64_t steps);
  void clear();

  bool is_empty() const { return moments_.empty(); }
  std::int64_t first() const { return moments_.empty() ? 0 : moments_.front().steps; }

  /// The last moment at or before so many steps, of those that there are.
  const LiveMoment& moment_before(std::int64_t steps) const;

  /// Repeats the changes between this step and the next.
  void repeat_changes(std::int64_t steps) const;

 private:
  struct Change {
    std::int64_t steps;
    std::function<void()> make;
  };

  std::deque<LiveMoment> moments_;  // by ascending steps
  std::deque<Change> changes_;      // likewise
};

}  // namespace weft::engine
