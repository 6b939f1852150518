#include "weft/contact/untangle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>

#include "weft/geometry/aabb_tree.h"
#include "weft/geometry/distance.h"
#include "weft/mesh/solid.h"

namespace weft::engine {
namespace {

constexpr int kMinRounds = 60, kMaxRounds = 600;  // limits of rounds …
constexpr int kMaxTriangles = 4'000'000;          // … and of triangles tested in them: some seconds
constexpr int kPullPasses = 20;                   // over all edges in a round
constexpr double kMaxStretch = 1.1;               // of an edge, or its stretch at the start
constexpr double kMinGap = 1e-4;                  // between cloth and the features it intersected [m]
constexpr double kMaxPushPerEdge = 0.5;  // no push is longer than this share of the cloth's mean edge
constexpr double kShortening = 0.1;      // of the mean edge: how far a cut's end moves in a round
constexpr double kLayerReach = 0.03;     // a lower layer is found up to this far above a higher one [m]
constexpr double kSamePlace = 2e-3;      // way of a vertex that changes nothing about its layers [m]
constexpr double kOnSurface = 1e-9;      // a point this near to a mesh lies on it [m]
constexpr double kSameWay = 0.5;  // least cosine between the ways out of two layers that belong together

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Closed shells at their pose, with a tree for nearest-point queries.
struct SolidMesh {
  TriangleMesh mesh;
  AabbTree tree;
};

/// A particle's depth in a solid, and the shortest way out.
struct Way {
  double depth;  // [m]
  Vec3 out;      // unit length
};

class Untangler {
 public:
  Untangler(const RepairInput& input, std::vector<Vec3>& x)
      : input_(input), surface_(*input.surface), inverse_mass_(*input.inverse_mass), x_(x) {
    measure_edges();
    is_on_solid_.resize(x_.size(), 0);
    for (const RepairInput::Solid& solid : input.solids) {
      meshes_.push_back(build_mesh(solid));
      for (const Triangle& t : solid.triangles) {
        for (const int v : t) is_on_solid_[v] = 1;
      }
    }
    build_trees();
  }

  /// Keeps the best of all rounds.
  UntangleResult run(const std::function<void(int round)>& on_round) {
    UntangleResult result;
    result.before = result.after = find_intersections();
    std::vector<Vec3> best = x_;
    Intersections intersections = result.after;
    const int num_triangles = static_cast<int>(surface_.triangles.size());
    const int most = std::clamp(kMaxTriangles / std::max(num_triangles, 1), kMinRounds, kMaxRounds);
    while (!intersections.empty() && result.rounds < most) {
      ++result.rounds;
      if (on_round) on_round(result.rounds);
      move_apart(intersections);
      intersections = find_intersections();
      if (!intersections.is_better_than(result.after)) continue;
      result.after = intersections;
      best = x_;
    }
    x_ = best;
    return result;
  }

  Intersections find_intersections() {
    Intersections intersections;
    cloth_tree_.refit([&](int t) { return box_of(x_, surface_.triangles[t]); }, *jobs_);
    PairSearch search;
    cloth_tree_.find_self_pairs(*jobs_, search);
    for (const auto& [s, t] : search.pairs) add_edge_face(s, t, intersections.edge_face);
    const int first = input_.num_cloth_triangles;
    if (static_cast<int>(surface_.triangles.size()) > first) {
      cloth_tree_.find_pairs(body_tree_, *jobs_, search);
      for (const auto& [s, t] : search.pairs) add_edge_face(s, t + first, intersections.edge_face);
    }
    for (int v = 0; v < input_.num_cloth_vertices; ++v) {
      const std::span<const int> one_ring = surface_.triangles_at(v);
      for (std::size_t f = 0; f < one_ring.size(); ++f) {
        for (std::size_t g = f + 1; g < one_ring.size(); ++g)
          add_edge_face(one_ring[f], one_ring[g], intersections.edge_face);
      }
    }
    std::sort(intersections.edge_face.begin(), intersections.edge_face.end());
    intersections.edge_face.erase(std::unique(intersections.edge_face.begin(), intersections.edge_face.end()),
                                  intersections.edge_face.end());
    is_inside_.assign(input_.num_cloth_vertices, 0);
    for (std::size_t s = 0; s < meshes_.size(); ++s) {
      for (const int v : find_inside(s)) {
        is_inside_[v] = 1;
        if (!is_free(v)) continue;
        intersections.inside.push_back({v, input_.solids[s].collider, way_out(s, x_[v]).depth});
      }
      add_inside_triangles(input_.solids[s], intersections.inside_triangles);
    }
    intersections.beneath = find_beneath();
    return intersections;
  }

 private:
  /// A round.
  void move_apart(const Intersections& intersections) {
    for (std::size_t s = 0; s < meshes_.size(); ++s) leave(s);
    push_ = std::vector<Vec3>(x_.size(), Vec3::Zero());
    count_ = std::vector<int>(x_.size(), 0);
    find_cuts(intersections.edge_face);
    for (const EdgeFaceIntersection& p : intersections.edge_face) push_back(p);
    for (const Beneath& b : intersections.beneath) {
      push_[b.vertex] += limited(b.depth + gap(b.vertex) + gap(surface_.triangles[b.triangle][0])) * b.out;
      ++count_[b.vertex];
    }
    for (int v = 0; v < input_.num_cloth_vertices; ++v) {
      if (count_[v] > 0) x_[v] += push_[v] / count_[v];
    }
    pull();
    for (std::size_t s = 0; s < meshes_.size(); ++s) leave(s);
    round();
  }

  bool is_cloth(int v) const { return v < input_.num_cloth_vertices; }
  bool is_free(int v) const { return inverse_mass_[v] > 0; }

  void measure_edges() {
    double sum = 0;
    int count = 0;
    neighbours_.resize(x_.size());
    for (const auto& [i, j] : surface_.edges) {
      const int edge = static_cast<int>(longest_.size());
      neighbours_[i].push_back({j, edge});
      neighbours_[j].push_back({i, edge});
      const bool is_of_cloth = is_cloth(i);
      const double rest = is_of_cloth ? (input_.rest[i] - input_.rest[j]).norm() : 0.0;
      longest_.push_back(std::max(kMaxStretch * rest, (x_[i] - x_[j]).norm()));
      if (!is_of_cloth) continue;
      sum += rest;
      ++count;
    }
    mean_edge_ = count > 0 ? sum / count : 0;
  }

  SolidMesh build_mesh(const RepairInput::Solid& solid) const {
    SolidMesh result;
    if (solid.triangles.empty()) return result;
    for (const auto& [i, j, k] : solid.triangles)
      result.mesh.triangles.push_back(
          {i - solid.first_vertex, j - solid.first_vertex, k - solid.first_vertex});
    result.mesh.positions.assign(x_.begin() + solid.first_vertex, x_.begin() + solid.end_vertex);
    std::vector<Aabb> boxes;
    for (const Triangle& t : result.mesh.triangles) boxes.push_back(box_of(result.mesh.positions, t));
    result.tree.build(boxes, {}, *jobs_);
    return result;
  }

  static Aabb box_of(const std::vector<Vec3>& x, const Triangle& t) {
    return make_aabb(x[t[0]].cwiseMin(x[t[1]]).cwiseMin(x[t[2]]),
                     x[t[0]].cwiseMax(x[t[1]]).cwiseMax(x[t[2]]));
  }

  void build_trees() {
    const int num_cloth = input_.num_cloth_triangles, num = static_cast<int>(surface_.triangles.size());
    std::vector<Aabb> boxes;
    for (const Triangle& t : surface_.triangles) boxes.push_back(box_of(x_, t));
    cloth_tree_.build({boxes.begin(), boxes.begin() + num_cloth},
                      {surface_.triangles.begin(), surface_.triangles.begin() + num_cloth}, *jobs_);
    if (num > num_cloth) body_tree_.build({boxes.begin() + num_cloth, boxes.end()}, {}, *jobs_);
  }

  // ---- Intersections ----

  void add_edge_face(int s, int t, std::vector<EdgeFaceIntersection>& edge_face) const {
    if (input_.non_colliding(surface_.triangles[s][0], surface_.triangles[t][0])) return;
    for (const auto& [owner, other] : {std::pair(s, t), std::pair(t, s)}) {
      const Triangle& triangle = surface_.triangles[other];
      for (const int e : surface_.owned[owner].edge) {
        if (e >= 0 && pierces(surface_.edges[e], triangle)) edge_face.push_back({e, other});
      }
    }
  }

  bool pierces(const std::array<int, 2>& e, const Triangle& t) const {
    if (has_vertex(t, e[0]) || has_vertex(t, e[1])) return false;
    return segment_triangle_distance(x_[e[0]], x_[e[1]], x_[t[0]], x_[t[1]], x_[t[2]]).distance_sq == 0;
  }

  // ---- Out of solids ----

  /// Cloth particles in a solid.
  std::vector<int> find_inside(std::size_t s) const {
    const int collider = input_.solids[s].collider;
    const ColliderShape& shape = input_.solids[s].shape;
    std::vector<int> found;
    const std::vector<Vec3> cloth(x_.begin(), x_.begin() + input_.num_cloth_vertices);
    std::vector<int> winding;
    if (std::holds_alternative<MeshShape>(shape)) winding = compute_winding_numbers(meshes_[s].mesh, cloth);
    for (int v = 0; v < input_.num_cloth_vertices; ++v) {
      const bool is_inside =
          winding.empty() ? signed_distance(shape, cloth[v]).distance < 0 : winding[v] != 0;
      if (is_inside && !input_.non_colliding_solid(v, collider)) found.push_back(v);
    }
    return found;
  }

  void add_inside_triangles(const RepairInput::Solid& solid, std::vector<InsideTriangle>& found) const {
    if (std::holds_alternative<MeshShape>(solid.shape)) return;
    const auto is_in = [&](int v) {
      return is_free(v) && signed_distance(solid.shape, x_[v]).distance < -kTouches;
    };
    for (int t = 0; t < input_.num_cloth_triangles; ++t) {
      const auto [i, j, k] = surface_.triangles[t];
      if (input_.non_colliding_solid(i, solid.collider) || !(is_free(i) || is_free(j) || is_free(k)))
        continue;
      if (signed_distance(solid.shape, x_[i], x_[j], x_[k], 0).distance >= -kTouches) continue;
      if (!is_in(i) && !is_in(j) && !is_in(k)) found.push_back({t, solid.collider});
    }
  }

  /// The way out for a particle that is inside.
  Way way_out(std::size_t s, const Vec3& p) const {
    const ColliderShape& shape = input_.solids[s].shape;
    if (!std::holds_alternative<MeshShape>(shape)) {
      const SignedDistance d = signed_distance(shape, p);
      return {-d.distance, d.normal};
    }
    const TriangleMesh& mesh = meshes_[s].mesh;
    const auto to = [&](int t) {
      const auto [i, j, k] = mesh.triangles[t];
      return point_triangle_distance(p, mesh.positions[i], mesh.positions[j], mesh.positions[k]);
    };
    const int t = meshes_[s].tree.find_nearest(p, kInfinity, [&](int item) { return to(item).distance_sq; });
    const auto [i, j, k] = mesh.triangles[t];
    const Vec3 foot = point_at(to(t).weights, mesh.positions[i], mesh.positions[j], mesh.positions[k]);
    const double depth = (foot - p).norm();
    const Vec3 face = (mesh.positions[j] - mesh.positions[i])
                          .cross(mesh.positions[k] - mesh.positions[i])
                          .stableNormalized();
    return {depth, depth > kOnSurface ? Vec3((foot - p) / depth) : face};
  }

  double gap(int v) const { return std::max(kMinGap, (*input_.half_thickness)[v]); }

  /// Moves all cloth out of a solid; triangles that only their corners have left are pushed out whole.
  void leave(std::size_t s) {
    std::vector<int> inside = find_inside(s);
    std::erase_if(inside, [&](int v) { return !is_free(v); });
    std::vector<Way> ways;
    for (const int v : inside) ways.push_back(way_out(s, x_[v]));
    const std::optional<Vec3> common = find_common_way(inside, ways);
    for (std::size_t n = 0; n < inside.size(); ++n) {
      Vec3& p = x_[inside[n]];
      if (common) {
        go_along(s, *common, p);
      } else {
        p += (ways[n].depth + gap(inside[n])) * ways[n].out;
      }
    }
    const ColliderShape& shape = input_.solids[s].shape;
    if (!std::holds_alternative<MeshShape>(shape)) lift_triangles(shape);
  }

  /// One common direction where neighbours would leave by opposite sides: the one nearest to all their ways,
  /// or else across the cloth.
  std::optional<Vec3> find_common_way(const std::vector<int>& inside, const std::vector<Way>& ways) const {
    std::vector<int> number(x_.size(), -1);
    for (std::size_t n = 0; n < inside.size(); ++n) number[inside[n]] = static_cast<int>(n);
    bool do_agree = true;
    for (const auto& [i, j] : surface_.edges) {
      if (!is_cloth(i) || number[i] < 0 || number[j] < 0) continue;
      do_agree &= ways[number[i]].out.dot(ways[number[j]].out) > 0;
    }
    if (do_agree) return {};
    Vec3 mean = Vec3::Zero(), across = Vec3::Zero();
    for (const Way& way : ways) mean += way.out / static_cast<double>(ways.size());
    for (const int v : inside) {
      for (const int t : surface_.triangles_at(v)) across += area(surface_.triangles[t]);
    }
    constexpr double kTelling = 0.3;  // a longer mean of the ways is a direction
    if (mean.norm() > kTelling || across.norm() == 0) return mean.stableNormalized();
    return Vec3(across.normalized() * (across.dot(mean) < 0 ? -1.0 : 1.0));
  }

  Vec3 area(const Triangle& t) const { return (x_[t[1]] - x_[t[0]]).cross(x_[t[2]] - x_[t[0]]); }

  /// Sphere tracing: no step is longer than the distance to the surface, so that the first way out is found.
  void go_along(std::size_t s, const Vec3& direction, Vec3& p) const {
    constexpr int kMaxSteps = 1000;
    for (int step = 0; step < kMaxSteps && is_in(s, p); ++step)
      p += (way_out(s, p).depth + kMinGap) * direction;
  }

  bool is_in(std::size_t s, const Vec3& p) const {
    const ColliderShape& shape = input_.solids[s].shape;
    if (!std::holds_alternative<MeshShape>(shape)) return signed_distance(shape, p).distance < 0;
    return compute_winding_numbers(meshes_[s].mesh, {p})[0] != 0;
  }

  void lift_triangles(const ColliderShape& shape) {
    for (int t = 0; t < input_.num_cloth_triangles; ++t) {
      const Triangle& v = surface_.triangles[t];
      const TriangleSignedDistance d = signed_distance(shape, x_[v[0]], x_[v[1]], x_[v[2]]);
      if (d.distance >= 0) continue;
      double give = 0;
      for (int k = 0; k < 3; ++k) give += is_free(v[k]) ? d.weights[k] * d.weights[k] : 0.0;
      if (give == 0) continue;
      for (int k = 0; k < 3; ++k) {
        if (is_free(v[k])) x_[v[k]] += (kMinGap - d.distance) * d.weights[k] / give * d.normal;
      }
    }
  }

  // ---- Layers ----

  int layer_of(int cloth_vertex) const { return input_.layers[mesh_at(cloth_vertex)]; }

  bool have_order() const {
    const auto is_ground = [](const RepairInput::Solid& s) { return std::holds_alternative<Plane>(s.shape); };
    return std::ranges::any_of(input_.layers, [&](int layer) { return layer != input_.layers[0]; }) &&
           !std::ranges::all_of(input_.solids, is_ground);
  }

  /// Away from the nearest solid that a vertex outside of all solids collides with. Planes do not count: they
  /// are ground, and wear no cloth.
  const Vec3& outward(int v) {
    Outward& known = outwards_[v];
    if (known.holds_at(x_[v])) return known.way;
    double nearest = kInfinity;
    for (std::size_t s = 0; s < input_.solids.size(); ++s) {
      const RepairInput::Solid& solid = input_.solids[s];
      if (std::holds_alternative<Plane>(solid.shape) || input_.non_colliding_solid(v, solid.collider))
        continue;
      const Way way = way_out(s, x_[v]);
      const double distance = std::abs(way.depth);
      if (distance >= nearest) continue;
      nearest = distance;
      // On the surface of a mesh, the way out is the face's normal; farther away, it points to the surface.
      const bool is_to_surface = std::holds_alternative<MeshShape>(solid.shape) && distance > kOnSurface;
      known.way = (is_to_surface ? -1.0 : 1.0) * way.out;
    }
    known.place = x_[v];
    return known.way;
  }

  /// Whether a lower layer is near.
  template <class IsLower>
  bool is_over_lower(int v, const IsLower& is_lower) {
    LowerLayer& known = lower_layers_[v];
    if (known.holds_at(x_[v])) return known.is_near;
    const Vec3 reach = Vec3::Constant(kLayerReach + 2 * kSamePlace);
    known = {{x_[v]}, false};
    cloth_tree_.for_each_overlapping(make_aabb(x_[v] - reach, x_[v] + reach),
                                     [&](int t) { known.is_near = known.is_near || is_lower(t); });
    return known.is_near;
  }

  Vec3 outward(const Triangle& t) { return outward(t[0]) + outward(t[1]) + outward(t[2]); }

  std::vector<Beneath> find_beneath() {
    std::vector<Beneath> found;
    if (!have_order()) return found;
    outwards_.resize(x_.size());
    lower_layers_.resize(x_.size());
    for (int v = 0; v < input_.num_cloth_vertices; ++v) {
      if (!is_free(v) || is_inside_[v]) continue;
      const auto is_lower = [&](int t) {
        const auto [i, j, k] = surface_.triangles[t];
        return layer_of(i) < layer_of(v) && !input_.non_colliding(v, i) && !is_inside_[i] && !is_inside_[j] &&
               !is_inside_[k];
      };
      if (!is_over_lower(v, is_lower)) continue;
      Beneath beneath{.vertex = v, .triangle = -1, .out = outward(v)};
      cloth_tree_.for_each_along_ray(x_[v], beneath.out, kLayerReach, [&](int t) {
        if (!is_lower(t)) return kLayerReach;
        const std::optional<double> way = way_to(surface_.triangles[t], x_[v], beneath.out);
        if (way && *way > beneath.depth &&
            outward(surface_.triangles[t]).normalized().dot(beneath.out) > kSameWay) {
          beneath.depth = *way;
          beneath.triangle = t;
        }
        return kLayerReach;
      });
      if (beneath.triangle >= 0) found.push_back(beneath);
    }
    return found;
  }

  /// The way from p to the triangle, no longer than kLayerReach.
  std::optional<double> way_to(const Triangle& t, const Vec3& p, const Vec3& direction) const {
    const Vec3 end = p + kLayerReach * direction;
    const SegmentTriangleDistance d = segment_triangle_distance(p, end, x_[t[0]], x_[t[1]], x_[t[2]]);
    if (d.distance_sq > 0) return {};
    return d.s * kLayerReach;
  }

  /// The end of an edge that is on the wrong side of another layer. Empty if the layers have no order, lie
  /// across the way out, or have been inside a solid.
  std::optional<int> find_wrong_by_layer(const EdgeFaceIntersection& p) {
    const Triangle& t = surface_.triangles[p.triangle];
    const auto& [i, j] = surface_.edges[p.edge];
    if (!is_cloth(i) || !is_cloth(t[0]) || layer_of(i) == layer_of(t[0]) || !have_order()) return {};
    if (is_inside_[t[0]] || is_inside_[t[1]] || is_inside_[t[2]]) return {};
    const Vec3 normal = area(t).stableNormalized();
    const double facing = normal.dot(outward(t).stableNormalized());
    if (std::abs(facing) < kSameWay) return {};
    const bool is_i_higher = (facing > 0 ? 1 : -1) * normal.dot(x_[i] - x_[j]) > 0;
    const bool is_outer = layer_of(i) > layer_of(t[0]);
    return is_i_higher == is_outer ? j : i;
  }

  // ---- Cuts ----

  bool is_solid(int triangle) const { return is_on_solid_[surface_.triangles[triangle][0]] != 0; }

  /// The cut of a surface by another one, or by itself, with the lighter of its two parts.
  struct Cut {
    int mesh = 0;
    std::vector<EdgeFaceIntersection> crossings;
    int side = 0;               // of the cutting triangles on which the lighter part is: +1 along normals
    double weight = kInfinity;  // of the lighter part [kg]
  };

  int mesh_at(int vertex) const { return mesh_of(input_.first_vertex, vertex); }

  int side_of(int vertex, const Triangle& t) const { return area(t).dot(x_[vertex] - x_[t[0]]) > 0 ? 1 : -1; }

  /// Key of a cut: the mesh, the mesh that cuts it, and the curve if a mesh cuts itself; for different meshes
  /// the curve is 0.
  using CutKey = std::array<int, 3>;

  CutKey key_of(const EdgeFaceIntersection& p) const {
    const int a = mesh_at(surface_.edges[p.edge][0]), b = mesh_at(surface_.triangles[p.triangle][0]);
    return {a, b, a == b ? root_of(p.edge) : 0};
  }

  int root_of(int edge) const {
    while (curve_[edge] != edge) edge = curve_[edge];
    return edge;
  }

  void find_cuts(const std::vector<EdgeFaceIntersection>& edge_face) {
    join_curves(edge_face);
    cuts_.clear();
    for (const EdgeFaceIntersection& p : edge_face) {
      if (!is_solid(p.triangle)) cuts_[key_of(p)].crossings.push_back(p);
    }
    for (auto& [key, cut] : cuts_) {
      cut.mesh = key[0];
      weigh(cut);
    }
  }

  /// Intersecting edges with a common adjacent triangle belong to one curve.
  void join_curves(const std::vector<EdgeFaceIntersection>& edge_face) {
    curve_.resize(surface_.edges.size());
    std::iota(curve_.begin(), curve_.end(), 0);
    std::map<int, int> edge_of_triangle;
    for (const EdgeFaceIntersection& p : edge_face) {
      surface_.for_triangles_with(surface_.edges[p.edge], [&](int t) {
        const auto [known, is_new] = edge_of_triangle.try_emplace(t, p.edge);
        if (is_new) return;
        const int a = root_of(known->second), b = root_of(p.edge);
        curve_[std::max(a, b)] = std::min(a, b);
      });
    }
  }

  /// Finds the lighter part: each particle takes the side of the nearest end of a cut edge on its side. This
  /// extends a cut that ends before the cloth's border.
  void weigh(Cut& cut) const {
    const int begin = input_.first_vertex[cut.mesh], end = input_.first_vertex[cut.mesh + 1];
    std::vector<int> side(end - begin, 0), queue;
    std::vector<char> is_cut(surface_.edges.size(), 0);
    for (const EdgeFaceIntersection& p : cut.crossings) {
      is_cut[p.edge] = 1;
      for (const int v : surface_.edges[p.edge]) {
        if (side[v - begin] == 0) queue.push_back(v);
        side[v - begin] = side_of(v, surface_.triangles[p.triangle]);
      }
    }
    for (std::size_t n = 0; n < queue.size(); ++n) {
      for (const auto& [neighbour, edge] : neighbours_[queue[n]]) {
        if (is_cut[edge] || side[neighbour - begin] != 0) continue;
        side[neighbour - begin] = side[queue[n] - begin];
        queue.push_back(neighbour);
      }
    }
    double above = 0, below = 0;
    for (const int v : queue)
      (side[v - begin] > 0 ? above : below) += inverse_mass_[v] > 0 ? 1 / inverse_mass_[v] : kInfinity;
    cut.side = above < below ? 1 : -1;
    cut.weight = std::min(above, below);
  }

  static constexpr int kNobody = -1;     // another cut handles this intersection
  static constexpr int kUndecided = -2;  // both parts are fixed

  /// The end of the edge that must move to the other side, if the lighter part of its own surface is lighter
  /// than that of the other one.
  int find_wrong(const EdgeFaceIntersection& p) const {
    const Triangle& t = surface_.triangles[p.triangle];
    const auto& [i, j] = surface_.edges[p.edge];
    const CutKey key = key_of(p);
    const Cut& own = cuts_.at(key);
    const auto is_before = [&](const CutKey& other_key, const Cut& other) {
      return other.weight < own.weight || (other.weight == own.weight && other_key < key);
    };
    bool is_others = false;
    for (const auto& [other_key, other] : cuts_) {
      if (other_key[0] != key[1] || other_key[1] != key[0] || other_key == key) continue;
      if (key[0] == key[1] && !has_edge_of(other_key[2], p.triangle)) continue;
      is_others |= is_before(other_key, other) && other.weight < kInfinity;
    }
    if (is_others) return kNobody;
    if (own.weight == kInfinity) return kUndecided;
    return side_of(i, t) == own.side ? i : j;
  }

  /// Whether a triangle has an edge of the given curve.
  bool has_edge_of(int curve, int triangle) const {
    const Triangle& t = surface_.triangles[triangle];
    bool has = false;
    for (const int v : t) {
      for (const auto& [neighbour, edge] : neighbours_[v])
        has |= has_vertex(t, neighbour) && root_of(edge) == curve;
    }
    return has;
  }

  // ---- Moves ----

  void push_back(const EdgeFaceIntersection& p) {
    const Triangle& t = surface_.triangles[p.triangle];
    const auto& [i, j] = surface_.edges[p.edge];
    if (is_solid(p.triangle)) return push_from_solid(p, area(t).stableNormalized());
    if (is_cloth(t[0]) && !is_cloth(i)) {
      if (const std::optional<Vec3> out = ridge_direction(p.edge)) return push_from_solid(p, *out);
    }
    const std::optional<int> by_layer = find_wrong_by_layer(p);
    const int wrong = by_layer ? *by_layer : find_wrong(p);
    if (wrong == kNobody) return;
    if (wrong == kUndecided) return shorten_cut(p);
    const int right = wrong == i ? j : i;
    const SegmentTriangleDistance d =
        segment_triangle_distance(x_[wrong], x_[right], x_[t[0]], x_[t[1]], x_[t[2]]);
    const Vec3 point = x_[wrong] + d.s * (x_[right] - x_[wrong]);
    Vec3 normal = area(t).stableNormalized();
    if (normal.dot(x_[right] - x_[wrong]) < 0) normal = -normal;
    const double shortfall = normal.dot(point - x_[wrong]) + gap(wrong) + gap(t[0]);
    move(std::array{wrong}, std::array{1.0}, t, d.weights, limited(shortfall) * normal);
  }

  double limited(double length) const { return std::min(length, kMaxPushPerEdge * mean_edge_); }

  /// The outward direction at an edge of a closed mesh; empty for an open one.
  std::optional<Vec3> ridge_direction(int edge) const {
    Vec3 sum = Vec3::Zero();
    bool is_on_solid = false;
    surface_.for_triangles_with(surface_.edges[edge], [&](int t) {
      is_on_solid |= is_solid(t);
      sum += area(surface_.triangles[t]).stableNormalized();
    });
    return is_on_solid ? std::optional(sum.stableNormalized()) : std::nullopt;
  }

  /// Pushes out cloth that penetrates a solid although all its corners are outside.
  void push_from_solid(const EdgeFaceIntersection& p, const Vec3& out) {
    const Triangle& t = surface_.triangles[p.triangle];
    const auto& [i, j] = surface_.edges[p.edge];
    const SegmentTriangleDistance d = segment_triangle_distance(x_[i], x_[j], x_[t[0]], x_[t[1]], x_[t[2]]);
    move(std::array{i, j}, std::array{1 - d.s, d.s}, t, d.weights,
         (is_cloth(i) ? 1.0 : -1.0) * limited(kShortening * mean_edge_) * out);
  }

  /// Moves the edge against the triangle that it intersects so that the end of the cut, where the edge's own
  /// triangles meet this one, moves towards the inside of the cut:
  ///
  ///     Σ R − (E·R)/(E·N) N        R along the cut from the edge, E along the edge, N the triangle's normal
  void shorten_cut(const EdgeFaceIntersection& p) {
    const Triangle& t = surface_.triangles[p.triangle];
    const auto& [i, j] = surface_.edges[p.edge];
    const Vec3 n = area(t).stableNormalized(), e = (x_[j] - x_[i]).stableNormalized();
    constexpr double kMinSine = 0.1;
    const double sine = std::abs(e.dot(n)) > kMinSine ? e.dot(n) : std::copysign(kMinSine, e.dot(n));
    Vec3 way = Vec3::Zero();
    surface_.for_triangles_with(surface_.edges[p.edge], [&](int s) {
      const Triangle& side = surface_.triangles[s];
      Vec3 along = area(side).cross(n).stableNormalized();
      const Vec3 inwards = area(side).cross(e);
      const Vec3 centre = (x_[side[0]] + x_[side[1]] + x_[side[2]]) / 3 - 0.5 * (x_[i] + x_[j]);
      const double is_in = inwards.dot(centre) > 0 ? 1 : -1;
      if (is_in * inwards.dot(along) < 0) along = -along;
      way += along - along.dot(e) / sine * n;
    });
    if (way.norm() < 1e-6) return;
    const SegmentTriangleDistance d = segment_triangle_distance(x_[i], x_[j], x_[t[0]], x_[t[1]], x_[t[2]]);
    const double length = kShortening * mean_edge_ * std::min(1.0, way.norm());
    move(std::array{i, j}, std::array{1 - d.s, d.s}, t, d.weights, length * way.normalized());
  }

  /// Moves points of an edge and a triangle against each other; vertices share by weight.
  template <std::size_t kCount>
  void move(const std::array<int, kCount>& first, const std::array<double, kCount>& weights,
            const Triangle& second, const Vec3& second_weights, const Vec3& way) {
    double give = 0;
    for (std::size_t k = 0; k < kCount; ++k) give += weights[k] * weights[k] * inverse_mass_[first[k]];
    for (int k = 0; k < 3; ++k) give += second_weights[k] * second_weights[k] * inverse_mass_[second[k]];
    if (give == 0) return;
    const auto add = [&](int v, double weight) {
      if (!is_free(v) || weight == 0) return;
      push_[v] += weight * inverse_mass_[v] / give * way;
      ++count_[v];
    };
    for (std::size_t k = 0; k < kCount; ++k) add(first[k], weights[k]);
    for (int k = 0; k < 3; ++k) add(second[k], -second_weights[k]);
  }

  // ---- Edge lengths ----

  /// Shortens edges that have become too long.
  void pull() {
    for (int pass = 0; pass < kPullPasses; ++pass) {
      bool is_done = true;
      for (std::size_t e = 0; e < surface_.edges.size(); ++e) {
        const auto& [i, j] = surface_.edges[e];
        if (!is_cloth(i)) break;
        const double give = inverse_mass_[i] + inverse_mass_[j];
        const Vec3 between = x_[j] - x_[i];
        const double length_sq = between.squaredNorm();
        if (give == 0 || length_sq <= longest_[e] * longest_[e]) continue;
        const double length = std::sqrt(length_sq);
        const Vec3 pull = (length - longest_[e]) / length / give * between;
        x_[i] += inverse_mass_[i] * pull;
        x_[j] -= inverse_mass_[j] * pull;
        is_done = false;
      }
      if (is_done) return;
    }
  }

  /// Rounds to positions that can be stored.
  void round() {
    for (int v = 0; v < input_.num_cloth_vertices; ++v) {
      const Vec3& origin = input_.origins[v];
      x_[v] = origin + (x_[v] - origin).cast<float>().cast<double>();
    }
  }

  const RepairInput& input_;
  const Surface& surface_;
  const std::vector<double>& inverse_mass_;
  std::vector<Vec3>& x_;
  std::shared_ptr<JobSystem> jobs_ = make_serial_jobs();
  std::vector<double> longest_;    // (edges) length limit [m]
  double mean_edge_ = 0;           // of cloth [m]
  std::vector<SolidMesh> meshes_;  // (solids)
  std::vector<char> is_on_solid_;  // (num_vertices) whether on a closed shell
  std::vector<char> is_inside_;    // (num_cloth_vertices) whether inside a solid before the round
  AabbTree cloth_tree_, body_tree_;
  /// What is known of a vertex as long as it stays near a place.
  struct Known {
    Vec3 place = Vec3::Constant(kInfinity);
    bool holds_at(const Vec3& p) const { return (place - p).norm() < kSamePlace; }
  };
  struct Outward : Known {
    Vec3 way = Vec3::UnitY();
  };
  struct LowerLayer : Known {
    bool is_near = false;
  };
  std::vector<Outward> outwards_;         // (num_vertices) where layers have an order
  std::vector<LowerLayer> lower_layers_;  // likewise
  std::vector<int> curve_;                // (edges) union-find forest of the edges that one curve cuts
  std::map<CutKey, Cut> cuts_;
  std::vector<std::vector<std::pair<int, int>>> neighbours_;  // (num_vertices) and the edge to each
  std::vector<Vec3> push_;                                    // (num_vertices) sum of a round's moves [m]
  std::vector<int> count_;                                    // (num_vertices) number of these moves
};

}  // namespace

Intersections find_intersections(const RepairInput& input, const std::vector<Vec3>& positions) {
  std::vector<Vec3> x = positions;
  return Untangler(input, x).find_intersections();
}

UntangleResult untangle(const RepairInput& input, std::vector<Vec3>& positions,
                        const std::function<void(int round)>& on_round) {
  return Untangler(input, positions).run(on_round);
}

}  // namespace weft::engine
