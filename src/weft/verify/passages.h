#pragma once
/// What goes through what from one moment to the next: cloth through itself, through other cloth and through
/// colliders. Two sheets that change sides between two moments cross at neither of them.
///
/// Vertices move in straight lines. A pair of features, a vertex and a triangle or two edges, passes where
/// the one is on the other side afterwards, decided exactly (pair_motion.h); what grazes, or comes back, does
/// not. A pair that touches exactly at a moment, to the last bit, stays open, and passes in the motion that
/// ends that, if it has then come out on the other side. Features that share a vertex are left out.
///
/// Sphere, capsule and box: a particle that is in one no deeper than a tolerance before and after, but was on
/// its way, has passed. The way is a straight line in the frame in which the shape rests. Where shapes turn
/// in themselves (balls, capsules), there are two such frames, one that turns along and one that does not,
/// and the way must be too deep in both. Besides, a sphere's centre, a capsule's axis, and the corners and
/// edges of a box less the tolerance are features that triangles and edges of cloth may pass: a bullet
/// smaller than a triangle. Nothing can pass a half space.

#include <map>
#include <string>
#include <vector>

#include "weft/verify/checker.h"
#include "weft/verify/feature_pairs.h"

namespace weft::engine::verify {

/// Watches a motion, moment by moment. All moments have the same cloths and colliders, as many vertices and
/// the same triangles; coordinates are in the range of pair_motion.h.
class PassageWatch {
 public:
  explicit PassageWatch(const Frame& start, double tolerance = 1e-4);  // in shapes [m]

  /// The pairs that pass in the motion from the last moment to this one, in order; `surface` and `other` are
  /// the cloths, then the colliders. Names that may pass are this moment's. A moment with coordinates that
  /// are not finite is left out.
  std::vector<FeaturePair> advance(const Frame& next);

  /// Motions that were not looked at, because cloth was flung about by more than its own size, or its
  /// coordinates were not finite.
  int num_left_out() const { return num_left_out_; }

 private:
  /// A pair that touches, or a particle in a shape.
  struct Open {
    bool is_through = false;  // as things stand
    bool is_known = true;     // false: it has been so from the first moment on
  };

  void read(const Frame& frame);
  void judge_features(const Frame& next);
  void judge_particles(const Frame& next, int cloth, int collider);
  void settle(const FeaturePair& pair, bool passes, bool is_open_before, bool is_open_after);

  double tolerance_;
  std::vector<MovingSurface> surfaces_;
  FeaturePairs pairs_;
  std::vector<NamedCollider> colliders_;  // at the last moment; of meshes only the kind counts
  std::map<FeaturePair, Open> open_, still_open_;
  std::vector<FeaturePair> passages_;
  int num_left_out_ = 0;
};

/// `cloth "sheet" particle 12 passes through cloth "rag" triangle 7`
std::string describe(const Frame& frame, const FeaturePair& passage);

}  // namespace weft::engine::verify
