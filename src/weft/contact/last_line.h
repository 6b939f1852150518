#pragma once
/// The last line: whatever a step's solve and contact have done, nothing goes through anything.
///
/// Looks at the whole motion of a step, in straight lines from start to end, and at every pair of features
/// that could meet. Where a pair does:
///
///     1. Impulses (Bridson, Fedkiw and Anderson 2002) move its end apart along the normal at the impact;
///        again and again, for what this makes meet elsewhere.
///
///     2. What still meets after that is joined into zones (Provot 1997; Harmon et al. 2008). A zone's motion
///        is split into the rigid one that fits it best and the rest, and the rest is scaled down, in the end
///        to nothing; zones that meet become one. Momentum is kept, and what moves rigidly meets nothing of
///        its own. Where a zone meets something that moves by prescription, it takes that motion.
///
///     3. What meets even then is between things whose prescribed motions leave no room. It is listed.
///
/// The ends looked at are those that will be stored, rounded as they will be.

#include <vector>

#include "weft/contact/constraint.h"
#include "weft/contact/moving_shape.h"
#include "weft/contact/proximity.h"
#include "weft/contact/shape_clearance.h"
#include "weft/geometry/time_of_impact.h"

namespace weft::engine {

/// A pair of features that prescribed motions have pushed through each other.
struct Infeasible {
  int vertex = 0, other = 0;  // one of each feature, under the common numbering; `other` -1: of a plain shape
  int shape = -1;             // number of the plain shape
};

/// What the last line had to do.
struct LastLineReport {
  int hits = 0;   // pairs that would have met, when first looked at
  int zones = 0;  // zones that were left to move rigidly, wholly or in part
  std::vector<Infeasible> infeasible;
};

/// A direction along which a triangle of cloth probably lies beyond all of a plain shape at the end of the
/// step.
struct Separation {
  int shape = 0;
  Triangle triangle = {};
  Vec3 normal = Vec3::UnitY();  // unit length
};

/// A closed mesh of a collider, under the common numbering.
struct ClosedMesh {
  int first_vertex = 0, end_vertex = 0;
  int first_triangle = 0, end_triangle = 0;
};

/// What it must know of a step, besides the motion.
struct LastLineStep {
  const std::vector<double>* inverse_mass = nullptr;  // (num_vertices) 0 where prescribed [1/kg]
  const std::vector<MovingShape>* shapes = nullptr;   // those that are meshes are looked at as vertices
  const std::vector<int>* first_vertex = nullptr;     // of each cloth, and the end of the last one
  const std::vector<Vec3>* origins = nullptr;  // (cloths) of which positions are stored as float offsets
  const std::vector<ClosedMesh>* closed_meshes = nullptr;
  const std::vector<char>* passes = nullptr;  // (cloths and shapes, the same) go through each other; or empty
  const ShapeClearance* clearance = nullptr;  // of cloth from plain shapes
  double thickest = 0;                        // half the thickness, of the thickest cloth [m]
  std::span<const Separation> separations = {};  // of some triangles, in the order of shapes and triangles
  WorkClock* clock = nullptr;                    // counts looks; null: they are not counted
};

class LastLine {
 public:
  /// Changes motion.end of vertices of cloth where it must. Pairs that touch or cross at the start are left
  /// alone, and so is what is inside a closed mesh: it may leave. `proximity` holds for the motion
  /// afterwards.
  LastLineReport hold(const LastLineStep& step, Proximity& proximity, SurfaceMotion& motion, JobSystem& jobs);

  /// The impulses of the last hold(): `push` tells what each moved [kg m].
  const std::vector<Constraint>& pushes() const { return pushes_; }

 private:
  /// A pair that meets, as what would keep it apart.
  struct Hit {
    Constraint constraint;
    bool is_edge_edge = false;
    Vec3 foot_start, foot_end;  // of a plain shape: its point there, and where it goes
  };

  /// A point that moves by prescription, and the vertex in whose zone it is.
  struct Guide {
    int vertex;
    Vec3 start, end;
  };

  struct Zone {
    int root;
    std::vector<int> vertices;
    std::vector<const Guide*> guides;
  };

  void find_hits(JobSystem& jobs, LastLineReport& report);
  void add_infeasible(const Hit& hit, LastLineReport& report) const;
  bool is_asked_for(const std::array<int, 4>& vertices, int count) const;
  bool is_rigid(const std::array<int, 4>& vertices) const;
  bool is_tangled(const Hit& hit) const;
  bool comes_from_inside(const Constraint& c) const;
  ImpactLimit limit_for(double thickness, int vertex) const;
  bool test_vertex_triangle(const FeaturePair& pair, Hit& hit) const;
  bool test_edge_edge(const FeaturePair& pair, Hit& hit) const;
  template <class Find>
  bool test_pair(const FeaturePair& pair, const std::array<int, 4>& vertex, const Find& find, Hit& hit) const;
  void find_shape_hits(int shape);
  bool keeps(const Separation& separation) const;
  bool pass(int vertex, int shape) const;
  bool test_triangle_shape(int shape, const Triangle& triangle, Hit& hit) const;
  void move(int vertex, const Vec3& to);
  void push_apart(JobSystem& jobs, LastLineReport& report);
  void join_zones(JobSystem& jobs, LastLineReport& report);
  void add_to_zones(const Hit& hit);
  int find_root(int vertex) const;
  void gather_zones();
  void scale_zone(const Zone& zone);
  int num_cloth_vertices() const { return step_.first_vertex->back(); }

  LastLineStep step_;
  Proximity* proximity_ = nullptr;
  SurfaceMotion* motion_ = nullptr;
  std::vector<Hit> hits_;
  bool only_moved_ = false;         // look at pairs with a vertex in is_moved_ alone
  std::vector<char> is_moved_;      // (num_vertices) since hits were looked for
  std::vector<Constraint> pushes_;  // impulses' constraints
  std::vector<int> near_pushes_;    // work space
  std::vector<Vec3> pushed_;        // (num_vertices) ends with impulses, before rounding

  // Zones.
  std::vector<Vec3> wanted_;      // (cloth vertices) where impulses have left them
  std::vector<int> parent_;       // (cloth vertices) of a union-find forest, -1: in no zone
  std::vector<double> share_;     // (cloth vertices) of a root: how much of the rest its zone keeps
  std::vector<char> is_halved_;   // (cloth vertices) of a root: share_ has been lowered in this round
  std::vector<char> is_carried_;  // (cloth vertices) of a root: its zone goes where its guides take it
  bool has_grown_ = false;        // this round has changed a zone
  std::vector<Guide> guides_;
  std::vector<Zone> zones_;

  std::vector<std::vector<Hit>> chunks_;
  std::vector<int> near_;        // vertices that may come near to a plain shape
  std::vector<char> is_near_;    // (cloth vertices) to a plain shape
  std::vector<Vec3> shape_end_;  // (cloth vertices) of near ones: the end in the frame of the shape's start
};

}  // namespace weft::engine
