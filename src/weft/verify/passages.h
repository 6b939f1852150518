#pragma once
/// Tunnelling between frames: cloth through itself, through other cloth and through colliders. Two sheets
/// that change sides between two frames intersect in neither of them.
///
/// Vertices move linearly. A feature pair, vertex–triangle or edge–edge, passes if one feature is on the
/// other side afterwards, decided exactly (pair_motion.h); grazing contact, or passing back, does not count.
/// A pair that touches exactly in a frame, to the last bit, stays open. It passes in the motion that ends the
/// touch, if it is then on the other side. Features that share a vertex are excluded.
///
/// Sphere, capsule and box: a particle has passed if it is at most a tolerance deep before and after, but
/// deeper on its path. The path is a straight line in the shape's rest frame. Rotationally symmetric shapes
/// (balls, capsules) have two such frames, one that rotates along and one that does not; the path must be too
/// deep in both. In addition, a sphere's centre, a capsule's axis, and the corners and edges of a box less
/// the tolerance are features that triangles and edges of cloth may pass: a bullet smaller than a triangle.
/// Nothing can pass a half space.

#include <map>
#include <string>
#include <vector>

#include "weft/verify/checker.h"
#include "weft/verify/feature_pairs.h"

namespace weft::engine::verify {

/// Checks a motion, frame by frame. All frames have the same cloths and colliders; coordinates are in the range of
/// pair_motion.h. Where cloth has torn, and its triangles have changed, the check begins again.
class PassageWatch {
 public:
  /// A touching pair, or a particle in a shape.
  struct Open {
    bool is_through = false;  // currently
    bool is_known = true;     // false: since the first frame
  };

  /// What a watch that begins at a later frame has to know of the frames before.
  struct Pending {
    std::map<FeaturePair, Open> open;
    int num_left_out = 0;
  };

  explicit PassageWatch(const Frame& start, double tolerance = 1e-4);  // in shapes [m]

  /// The pairs that pass in the motion from the last frame to this one, in order; `surface` and `other` are
  /// the cloths, then the colliders. The collision filter is this frame's. A frame with non-finite
  /// coordinates is skipped.
  std::vector<FeaturePair> advance(const Frame& next);

  /// Skipped motions: cloth moved by more than its own size, or its coordinates were not finite.
  int num_left_out() const { return pending_.num_left_out; }

  const Pending& pending() const { return pending_; }
  void set_pending(Pending pending) { pending_ = std::move(pending); }

 private:
  bool fits(const Frame& frame) const;
  void read(const Frame& frame);
  void test_features(const Frame& next);
  void test_particles(const Frame& next, int cloth, int collider);
  void settle(const FeaturePair& pair, bool passes, bool is_open_before, bool is_open_after);

  double tolerance_;
  std::vector<MovingSurface> surfaces_;
  FeaturePairs pairs_;
  std::vector<NamedCollider> colliders_;  // in the last frame; of meshes only the kind counts
  Pending pending_;
  std::map<FeaturePair, Open> still_open_;
  std::vector<FeaturePair> passages_;
};

/// `cloth "sheet" particle 12 passes through cloth "rag" triangle 7`
std::string describe(const Frame& frame, const FeaturePair& passage);

}  // namespace weft::engine::verify
