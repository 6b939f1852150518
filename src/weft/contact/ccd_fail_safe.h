#pragma once
/// CCD fail-safe: whatever the solve and the contact projection leave, a step ends without penetrations.
///
/// Continuous collision detection tests the whole motion of a step, as straight lines from start to end, for
/// every pair of features that could meet. Hits are resolved in three stages:
///
///     1. Impulses (Bridson, Fedkiw and Anderson 2002) separate the pair's end positions along the normal at
///        the impact, repeatedly, because a correction may cause new hits.
///
///     2. Remaining hits are joined into rigid impact zones (Provot 1997; Harmon et al. 2008). The motion of
///        a zone is split into the best-fitting rigid motion and a remainder, and the remainder is scaled
///        down, in the end to zero; zones that meet are merged. Momentum is kept, and rigid motion causes no
///        hits within the zone. A zone that meets a kinematic body takes that body's motion.
///
///     3. Hits that remain are between bodies whose kinematic motions are infeasible. They are listed.
///
/// The tested end positions are those that will be stored, with their rounding.

#include <vector>

#include "weft/contact/caught_particles.h"
#include "weft/contact/constraint.h"
#include "weft/contact/moving_shape.h"
#include "weft/contact/numbering.h"
#include "weft/contact/proximity.h"
#include "weft/contact/shape_clearance.h"
#include "weft/geometry/time_of_impact.h"

namespace weft::engine {

/// Infeasible kinematic motions: a pair of features that they have pushed through each other.
struct Infeasible {
  int vertex = 0, other = 0;  // one of each feature, under the common numbering; `other` -1: see `shape`
  int shape = -1;             // number of the primitive shape, or of the collider that catches the vertex
};

/// Work done by the CCD fail-safe.
struct CcdFailSafeReport {
  int hits = 0;   // pairs that would have met, in the first detection
  int zones = 0;  // rigid impact zones that remained, wholly or partly rigid
  std::vector<Infeasible> infeasible;
};

/// Separating axis: a direction along which a cloth triangle probably lies beyond a whole primitive shape at
/// the end of the step.
struct Separation {
  int shape = 0;
  Triangle triangle = {};
  Vec3 normal = Vec3::UnitY();  // unit length
};

/// The input of a step besides the motion.
struct CcdFailSafeStep {
  const std::vector<double>* inverse_mass = nullptr;  // (num_vertices) 0 where prescribed [1/kg]
  const std::vector<MovingShape>* shapes = nullptr;   // mesh colliders are tested as vertices instead
  const std::vector<int>* first_vertex = nullptr;     // of each cloth, and the end of the last one
  const std::vector<Vec3>* origins = nullptr;  // (cloths) of which positions are stored as float offsets
  const std::vector<ColliderMesh>* bodies = nullptr;
  const std::vector<char>* non_colliding =
      nullptr;                                   // (cloths and shapes, the same) 1: do not collide; or empty
  const ShapeClearance* clearance = nullptr;     // of cloth from primitive shapes
  const CaughtParticles* caught = nullptr;       // not tested against what holds them; null: none
  double thickest = 0;                           // half thickness of the thickest cloth [m]
  std::span<const Separation> separations = {};  // of some triangles, in the order of shapes and triangles
  WorkClock* clock = nullptr;                    // counts detections; null: not counted
};

class CcdFailSafe {
 public:
  /// Changes motion.end of cloth vertices where necessary. Ignores pairs that touch or intersect at the
  /// start, and features inside a closed mesh: they may leave. `proximity` then holds for the motion.
  CcdFailSafeReport resolve(const CcdFailSafeStep& step, Proximity& proximity, SurfaceMotion& motion,
                            JobSystem& jobs);

  /// The impulses of the last resolve(): `push` holds how much each moved [kg m].
  const std::vector<Constraint>& pushes() const { return pushes_; }

 private:
  /// A CCD hit, stored as the constraint that would separate the pair.
  struct Hit {
    Constraint constraint;
    bool is_edge_edge = false;
    Vec3 foot_start, foot_end;  // primitive shape: contact point at start and end
  };

  /// A kinematic point, and a vertex of the zone that it belongs to.
  struct Guide {
    int vertex;
    Vec3 start, end;
  };

  struct Zone {
    int root;
    std::vector<int> vertices;
    std::vector<const Guide*> guides;
  };

  void find_hits(JobSystem& jobs, CcdFailSafeReport& report);
  void add_infeasible(const Hit& hit, CcdFailSafeReport& report) const;
  bool needs_test(const std::array<int, 4>& vertices, int count) const;
  bool is_rigid(const std::array<int, 4>& vertices) const;
  bool starts_intersecting(const Hit& hit) const;
  bool comes_from_inside(const Constraint& c) const;
  ImpactLimit limit_for(double thickness, int vertex) const;
  bool test_vertex_triangle(const FeaturePair& pair, Hit& hit) const;
  bool test_edge_edge(const FeaturePair& pair, Hit& hit) const;
  template <class Find>
  bool test_pair(const FeaturePair& pair, const std::array<int, 4>& vertex, const Find& find, Hit& hit) const;
  void find_shape_hits(int shape);
  bool keeps(const Separation& separation) const;
  bool is_caught(std::span<const int> vertices, int shape) const;
  bool is_non_colliding(int vertex, int shape) const;
  bool test_triangle_shape(int shape, const Triangle& triangle, Hit& hit) const;
  void move(int vertex, const Vec3& to);
  void push_apart(JobSystem& jobs, CcdFailSafeReport& report);
  void join_zones(JobSystem& jobs, CcdFailSafeReport& report);
  void add_to_zones(const Hit& hit);
  int find_root(int vertex) const;
  void gather_zones();
  void scale_zone(const Zone& zone);
  int num_cloth_vertices() const { return step_.first_vertex->back(); }

  CcdFailSafeStep step_;
  Proximity* proximity_ = nullptr;
  SurfaceMotion* motion_ = nullptr;
  std::vector<Hit> hits_;
  bool only_moved_ = false;         // test only pairs with a vertex in is_moved_
  std::vector<char> is_moved_;      // (num_vertices) since the last detection
  std::vector<Constraint> pushes_;  // constraints of the impulses
  std::vector<int> near_pushes_;    // work space
  std::vector<Vec3> pushed_;        // (num_vertices) end positions with impulses, before rounding

  // Zones.
  std::vector<Vec3> wanted_;      // (cloth vertices) end positions after the impulses
  std::vector<int> parent_;       // (cloth vertices) union-find forest, -1: in no zone
  std::vector<double> share_;     // (cloth vertices) of a root: share of the remainder its zone keeps
  std::vector<char> is_halved_;   // (cloth vertices) of a root: share_ has been lowered in this round
  std::vector<char> is_carried_;  // (cloth vertices) of a root: its zone follows its guides
  bool has_grown_ = false;        // a zone changed in this round
  std::vector<Guide> guides_;
  std::vector<Zone> zones_;

  std::vector<std::vector<Hit>> chunks_;
  std::vector<int> near_;        // vertices that may come near to a primitive shape
  std::vector<char> is_near_;    // (cloth vertices) to a primitive shape
  std::vector<Vec3> shape_end_;  // (cloth vertices) of near ones: the end in the frame of the shape's start
};

}  // namespace weft::engine
