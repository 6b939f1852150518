#pragma once
/// Problems of a run, found in its frames and steps: reasons not to trust a result that is complete.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "weft/run/warnings.h"

namespace weft::engine {

struct RunProblem {
  WarningCode code = WarningCode::not_converged;
  int frames = 0;       // or steps, with the problem; 1 for problems found at the end [1]
  double value = 0;     // the worst, as in StepWarning
  std::string message;  // the problem, and the key to change
};

/// Those of the world as it is (see weft::find_problems).
std::vector<StepWarning> find_problems(const World& world);

/// Collects problems frame by frame.
///
///     yarn_strain    beyond 1.25 times the fabric's limit, 0.15 if it has none, for more than five frames in
///                    a row
///     flat_triangle  below a tenth of its area, for more than five frames in a row
///     open_seam      after the seams' time, by more than a quarter of an edge, likewise
///     energy_rise    in a frame, without external drive, by more than 2 % of the energy that has been in motion
///                    or lost so far, and by more than the energy that lifts all cloth by its thickness
///     cap_reached, contact_skipped, not_converged   by steps
///     infeasible     pairs, each once
///     crossings      in the last frame
///     penetration    deeper than 0.1 mm in the last frame
///     passages       in all frames
class ProblemFinder {
 public:
  struct Record {
    StepWarning worst;
    int frames = 0, consecutive = 0;
    bool is_reported = false;
  };

  /// What was found so far.
  struct Found {
    std::vector<Record> strained, flat, open;  // (cloths)
    std::vector<Record> others;
    std::vector<InfeasiblePair> infeasible;
    std::optional<StepWarning> inside;
    int num_frames = 0, crossings = 0, passages = 0;
    double energy = 0, max_energy = 0, min_energy = 0;  // in the last frame, and in all [J]
    double max_kinetic = 0;                             // in all [J]
  };

  explicit ProblemFinder(const World& world) : world_(world) {}

  /// Of a run that is continued.
  ProblemFinder(const World& world, Found found) : world_(world), found_(std::move(found)) {}

  const Found& found() const { return found_; }

  void add_step(const StepReport& step);

  /// Energies of all cloths [J].
  void add_frame(double kinetic, double potential);

  /// Pairs of triangles that cross in the last frame.
  void set_crossings(int count) { found_.crossings = count; }

  /// Cloth inside a collider in the last frame: a warning `penetration`.
  void set_inside(const std::optional<StepWarning>& inside) { found_.inside = inside; }

  /// `count` more pairs of features that passed through each other.
  void add_passages(int count) { found_.passages += count; }

  /// The worst of each code and cloth, in the order of codes.
  std::vector<RunProblem> problems() const;

 private:
  void record_warning(const StepWarning& warning);
  void check_cloth(int cloth);
  void check_energy(double kinetic, double potential);
  static void update(Record& record, const StepWarning& warning, bool is_wrong, bool is_worse);

  const World& world_;
  Found found_;
};

}  // namespace weft::engine
