/// Proximity against brute force: every pair of features, at many times of the step.

#include "weft/contact/proximity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "tests/support.h"
#include "weft/animation/rigid_motion.h"
#include "weft/contact/cloth_clearance.h"
#include "weft/geometry/distance.h"

namespace weft::engine {
namespace {

constexpr double kCell = 0.05;           // of the sheets [m]
constexpr double kHalfThickness = 2e-3;  // [m]
constexpr double kGap = 2 * kHalfThickness;
constexpr double kSlack = 0.15 * kCell;

using Pairs = std::set<std::array<int, 2>>;

/// Cloths and bodies, at present and at rest.
struct Scene {
  struct Sheet {
    Grid grid;
    int first_vertex, first_triangle;
  };

  Surface surface;
  std::vector<Sheet> sheets;
  bool are_meshes = false;  // treats grids as general meshes
  std::vector<Vec3> rest, places;
  int num_cloth_vertices = 0, num_cloth_triangles = 0;

  void add_sheet(int cells, const std::function<Vec3(const Vec3&)>& place) {
    const TriangleMesh grid = build_grid_mesh(test::square(cells, kCell * cells), GridDiagonals::alternating);
    sheets.push_back({test::square(cells, kCell * cells), surface.num_vertices,
                      static_cast<int>(surface.triangles.size())});
    surface.add(grid.triangles, grid.num_vertices());
    for (const Vec3& p : grid.positions) {
      rest.push_back(p);
      places.push_back(place(p));
    }
    num_cloth_vertices = surface.num_vertices;
    num_cloth_triangles = static_cast<int>(surface.triangles.size());
  }

  void add_body(const TriangleMesh& mesh) {  // after the last sheet
    surface.add(mesh.triangles, mesh.num_vertices());
    places.insert(places.end(), mesh.positions.begin(), mesh.positions.end());
  }

  Proximity make_proximity() const {
    Surface finished = surface;
    finished.build_one_rings();
    Patches patches;
    for (const Sheet& sheet : sheets) {
      const int end = sheet.first_triangle + 2 * sheet.grid.cells_x * sheet.grid.cells_z;
      if (are_meshes)
        patches.add_mesh(finished, rest, sheet.first_triangle, end, *make_serial_jobs());
      else
        patches.add_grid(finished, sheet.grid, sheet.first_vertex, sheet.first_triangle);
    }
    patches.add_body(finished, num_cloth_triangles, static_cast<int>(finished.triangles.size()));
    Proximity proximity;
    proximity.reset(finished, patches, rest, num_cloth_vertices, num_cloth_triangles,
                    {kSlack, kSlack, 2 * kSlack});
    return proximity;
  }

  SurfaceMotion motion_to(const std::vector<Vec3>& end) const {
    return {places, end, std::vector<double>(places.size(), kHalfThickness)};
  }
};

/// Brute force: feature pairs within the sum of their half thicknesses, at the ends of the step or at one of
/// a few times between.
class BruteForce {
 public:
  BruteForce(const Proximity& proximity, int num_cloth_vertices, const SurfaceMotion& motion)
      : surface_(proximity.surface()), num_cloth_vertices_(num_cloth_vertices), motion_(motion) {
    vertex_owner_.assign(surface_.num_vertices, -1);
    edge_owner_.assign(surface_.edges.size(), -1);
    for (int t = 0; t < static_cast<int>(surface_.triangles.size()); ++t) {
      for (const int v : surface_.owned[t].vertex) {
        if (v >= 0) vertex_owner_[v] = t;
      }
      for (const int e : surface_.owned[t].edge) {
        if (e >= 0) edge_owner_[e] = t;
      }
    }
    constexpr int kMoments = 5;
    for (int m = 0; m < kMoments; ++m) add_moment(m / double{kMoments - 1});
  }

  Pairs vertex_triangle, edge_edge;                    // of triangles that are not neighbours
  Pairs one_ring_vertex_triangle, one_ring_edge_edge;  // of triangles that share a sharp vertex

 private:
  static bool are_near(const Vec3& a_min, const Vec3& a_max, const Vec3& b_min, const Vec3& b_max) {
    return ((a_min - b_max).array() <= kGap).all() && ((b_min - a_max).array() <= kGap).all();
  }

  void add_moment(double share) {
    std::vector<Vec3> x(motion_.start.size());
    for (std::size_t v = 0; v < x.size(); ++v)
      x[v] = motion_.start[v] + share * (motion_.end[v] - motion_.start[v]);
    const bool is_at_end = share == 0 || share == 1;
    for (int t = 0; t < static_cast<int>(surface_.triangles.size()); ++t) {
      const auto [i, j, k] = surface_.triangles[t];
      const Vec3 low = x[i].cwiseMin(x[j]).cwiseMin(x[k]), high = x[i].cwiseMax(x[j]).cwiseMax(x[k]);
      for (int v = 0; v < surface_.num_vertices; ++v) {
        if (v == i || v == j || v == k || vertex_owner_[v] < 0) continue;
        if (v >= num_cloth_vertices_ && i >= num_cloth_vertices_) continue;
        if (!are_near(x[v], x[v], low, high)) continue;
        if (point_triangle_distance(x[v], x[i], x[j], x[k]).distance() > kGap) continue;
        add({v, t}, vertex_owner_[v], t, is_at_end ? &x : nullptr, vertex_triangle, one_ring_vertex_triangle);
      }
    }
    for (int e = 0; e < static_cast<int>(surface_.edges.size()); ++e) {
      const auto [i, j] = surface_.edges[e];
      const Vec3 low = x[i].cwiseMin(x[j]), high = x[i].cwiseMax(x[j]);
      for (int f = e + 1; f < static_cast<int>(surface_.edges.size()); ++f) {
        const auto [k, l] = surface_.edges[f];
        if (i == k || i == l || j == k || j == l) continue;
        if (i >= num_cloth_vertices_ && k >= num_cloth_vertices_) continue;
        if (!are_near(low, high, x[k].cwiseMin(x[l]), x[k].cwiseMax(x[l]))) continue;
        if (edge_edge_distance(x[i], x[j], x[k], x[l]).distance() > kGap) continue;
        add({e, f}, edge_owner_[e], edge_owner_[f], is_at_end ? &x : nullptr, edge_edge, one_ring_edge_edge);
      }
    }
  }

  void add(const std::array<int, 2>& pair, int owner_a, int owner_b, const std::vector<Vec3>* x, Pairs& pairs,
           Pairs& one_ring_pairs) const {
    const Triangle &a = surface_.triangles[owner_a], &b = surface_.triangles[owner_b];
    const int shared = num_shared_vertices(a, b);
    if (shared == 0) pairs.insert(pair);
    if (shared != 1 || !x) return;
    const int v =
        *std::find_if(a.begin(), a.end(), [&](int i) { return i == b[0] || i == b[1] || i == b[2]; });
    if (is_sharp(v, *x)) one_ring_pairs.insert(pair);
  }

  /// Whether a triangle around v deviates by more than 45° from the sum of normals, as in proximity.h.
  bool is_sharp(int v, const std::vector<Vec3>& x) const {
    std::vector<Vec3> normals;
    Vec3 sum = Vec3::Zero();
    for (int f = surface_.one_ring_begin[v]; f < surface_.one_ring_begin[v + 1]; ++f) {
      const auto [i, j, k] = surface_.triangles[surface_.one_ring[f]];
      normals.push_back((x[j] - x[i]).cross(x[k] - x[i]).stableNormalized());
      sum += normals.back();
    }
    return std::any_of(normals.begin(), normals.end(),
                       [&](const Vec3& n) { return n.dot(sum) < std::sqrt(0.5) * 0.98 * sum.norm(); });
  }

  const Surface& surface_;
  int num_cloth_vertices_;
  const SurfaceMotion& motion_;
  std::vector<int> vertex_owner_, edge_owner_;
};

Pairs as_set(const std::vector<FeaturePair>& pairs) {
  Pairs result;
  for (const FeaturePair& p : pairs) result.insert({p.a, p.b});
  EXPECT_EQ(result.size(), pairs.size()) << "no pair is listed twice";
  return result;
}

Pairs missing(const Pairs& wanted, const Pairs& found) {
  Pairs result;
  std::set_difference(wanted.begin(), wanted.end(), found.begin(), found.end(),
                      std::inserter(result, result.end()));
  return result;
}

/// Compares the lists with brute force; returns the number of close pairs.
std::size_t check(Proximity& proximity, const Scene& scene, const SurfaceMotion& motion,
                  const std::string& where, bool with_one_ring_pairs = false) {
  const BruteForce brute_force(proximity, scene.num_cloth_vertices, motion);
  const Pairs vt = as_set(proximity.vertex_triangle()), ee = as_set(proximity.edge_edge());
  const auto is_sorted = [](const std::vector<FeaturePair>& pairs) {
    return std::is_sorted(pairs.begin(), pairs.end(), [](const auto& x, const auto& y) {
      return std::pair(x.a, x.b) < std::pair(y.a, y.b);
    });
  };
  EXPECT_TRUE(is_sorted(proximity.vertex_triangle())) << where;
  EXPECT_TRUE(is_sorted(proximity.edge_edge())) << where;
  EXPECT_EQ(missing(brute_force.vertex_triangle, vt).size(), 0u) << where;
  EXPECT_EQ(missing(brute_force.edge_edge, ee).size(), 0u) << where;
  if (with_one_ring_pairs) {
    EXPECT_EQ(missing(brute_force.one_ring_vertex_triangle, vt).size(), 0u) << where;
    EXPECT_EQ(missing(brute_force.one_ring_edge_edge, ee).size(), 0u) << where;
  }
  double longest = 0;
  for (const auto& [i, j] : proximity.surface().edges) {
    if (i < scene.num_cloth_vertices) longest = std::max(longest, (motion.end[j] - motion.end[i]).norm());
  }
  EXPECT_GE(proximity.longest_edge(), longest) << where;
  return brute_force.vertex_triangle.size() + brute_force.edge_edge.size();
}

/// A strip folded back and forth in `layers` layers along x, `gap` apart.
Vec3 fold(const Vec3& p, double length, double gap) {
  const int layer = static_cast<int>(p.x() / length);
  const double along = p.x() - layer * length;
  return {layer % 2 == 0 ? along : length - along, layer * gap, p.z()};
}

/// Cloth layouts.
std::map<std::string, Scene> make_scenes() {
  std::map<std::string, Scene> scenes;
  const auto same = [](const Vec3& p) { return p; };
  scenes["flat"].add_sheet(6, same);
  scenes["folded"].add_sheet(8, [](const Vec3& p) { return fold(p, 2 * kCell, 0.7 * kHalfThickness); });
  Random random(5);
  scenes["crumpled"].add_sheet(
      7, [&](const Vec3& p) { return Vec3(0.35 * p + test::random_vector(random, kCell)); });
  scenes["coincident"].add_sheet(5, same);
  scenes["coincident"].add_sheet(5, same);
  scenes["two cloths"].add_sheet(5, same);
  scenes["two cloths"].add_sheet(4, [&](const Vec3& p) {
    return Vec3(p + Vec3(0.03, 0.5 * kHalfThickness, 0.02) + test::random_vector(random, kHalfThickness));
  });
  const Vec3 center(0.15, -0.1, 0.15);
  scenes["on a mesh"].add_sheet(6, [&](const Vec3& p) {
    const Vec3 from_center = p + Vec3(0, 0.001, 0) - center;
    return Vec3(center + 0.1 * from_center.normalized());
  });
  scenes["on a mesh"].add_body(make_sphere_mesh(center, 0.0985, 6));
  scenes["one triangle"].add_sheet(1, same);
  scenes["one triangle"].add_body(make_box_mesh({0, -0.05, 0}, {0.1, 0.05, 0.1}, Mat3::Identity()));
  for (const double radius : {0.03, 0.12}) {  // bent in an arc, and rolled up into self contact
    scenes["rolled, " + std::to_string(radius)].add_sheet(12, [&](const Vec3& p) {
      return Vec3(radius * std::sin(p.x() / radius), radius * std::cos(p.x() / radius), p.z());
    });
  }
  std::map<std::string, Scene> all = scenes;
  for (const auto& [name, scene] : scenes) {
    all[name + ", as a mesh"] = scene;
    all[name + ", as a mesh"].are_meshes = true;
  }
  return all;
}

TEST(Proximity, FindsEveryPairOfASceneAtRest) {
  const auto jobs = make_serial_jobs();
  for (const auto& [name, scene] : make_scenes()) {
    Proximity proximity = scene.make_proximity();
    const SurfaceMotion motion = scene.motion_to(scene.places);
    proximity.update(motion, *jobs);
    const std::size_t close = check(proximity, scene, motion, name, true);
    EXPECT_EQ(close == 0, name.starts_with("flat") || name.starts_with("rolled, 0.12"))
        << name << ": the scene should have something close";
  }
}

TEST(Proximity, OfAFlatSheetListsOnlyWhatIsNear) {
  // Second neighbours are a cell apart, more than slack plus thickness: nothing is listed.
  const Scene scene = make_scenes().at("flat");
  Proximity proximity = scene.make_proximity();
  proximity.update(scene.motion_to(scene.places), *make_serial_jobs());
  EXPECT_EQ(proximity.vertex_triangle().size(), 0u);
  EXPECT_EQ(proximity.edge_edge().size(), 0u);
}

/// Steps in which each vertex moves separately, by up to `size`.
void check_random_motion(double size, bool keeps_direction, int num_steps) {
  const auto jobs = make_serial_jobs();
  for (auto& [name, scene] : make_scenes()) {
    Proximity proximity = scene.make_proximity();
    Random random(9);
    std::vector<Vec3> velocity;
    for (std::size_t v = 0; v < scene.places.size(); ++v)
      velocity.push_back(test::random_vector(random, size));
    for (int s = 0; s < num_steps; ++s) {
      std::vector<Vec3> end = scene.places;
      for (std::size_t v = 0; v < end.size(); ++v) {
        if (!keeps_direction) velocity[v] = test::random_vector(random, size);
        end[v] += velocity[v];
      }
      const SurfaceMotion motion = scene.motion_to(end);
      proximity.update(motion, *jobs);
      check(proximity, scene, motion, name + ", step " + std::to_string(s));
      scene.places = end;
    }
  }
}

TEST(Proximity, MissesNothingOverManySmallSteps) { check_random_motion(0.04 * kSlack, true, 40); }

TEST(Proximity, MissesNothingInASmallTremble) { check_random_motion(0.3 * kSlack, false, 15); }

TEST(Proximity, MissesNothingInBigJumps) { check_random_motion(1.5 * kCell, false, 6); }

TEST(Proximity, MissesNothingWhereOnlyAPartMoves) {
  // Below the share at which all pairs are searched again, while all vertices drift.
  const auto jobs = make_serial_jobs();
  for (auto& [name, scene] : make_scenes()) {
    Proximity proximity = scene.make_proximity();
    Random random(11);
    for (int s = 0; s < 20; ++s) {
      std::vector<Vec3> end = scene.places;
      for (int v = 0; v < static_cast<int>(end.size()); ++v) {
        if (v < scene.num_cloth_vertices) end[v] += Vec3(0.01, -0.02, 0);
        if (random.uniform(0, 1) < 0.15) end[v] += test::random_vector(random, kCell);
      }
      const SurfaceMotion motion = scene.motion_to(end);
      proximity.update(motion, *jobs);
      check(proximity, scene, motion, name + ", step " + std::to_string(s));
      scene.places = end;
    }
  }
}

TEST(Proximity, MissesNothingWhereEverythingTurnsAndTravels) {
  const auto jobs = make_serial_jobs();
  for (auto& [name, scene] : make_scenes()) {
    Proximity proximity = scene.make_proximity();
    const Scene before = scene;
    for (int s = 1; s <= 12; ++s) {
      // The bodies are static: cloth passes them by.
      const Mat3 turn = rotation_from_angles_deg({7.0 * s, 11.0 * s, 0});
      std::vector<Vec3> end = scene.places;
      for (int v = 0; v < scene.num_cloth_vertices; ++v) {
        end[v] = turn * before.places[v] + s * Vec3(0.01, -0.02, 0.005);
      }
      const SurfaceMotion motion = scene.motion_to(end);
      proximity.update(motion, *jobs);
      check(proximity, scene, motion, name + ", step " + std::to_string(s));
      scene.places = end;
    }
  }
}

TEST(Proximity, MissesNothingFarFromTheWorldsOrigin) {
  // Boxes are floats, 1 mm apart at 10 km: they must be relative to a near origin.
  const auto jobs = make_serial_jobs();
  for (auto& [name, scene] : make_scenes()) {
    for (Vec3& p : scene.places) p += Vec3(1e4, 2e3, -3e4);
    Proximity proximity = scene.make_proximity();
    const SurfaceMotion motion = scene.motion_to(scene.places);
    proximity.update(motion, *jobs);
    check(proximity, scene, motion, name);
    EXPECT_LT(proximity.vertex_triangle().size(), 20000u) << name << ": and does not list everything";
  }
}

TEST(Proximity, MissesNothingWhenTheClothBecomesThicker) {
  const auto jobs = make_serial_jobs();
  Scene scene;
  scene.add_sheet(4, [](const Vec3& p) { return p; });
  scene.add_sheet(4, [](const Vec3& p) { return Vec3(p + Vec3(0.01, 0.02, 0.01)); });
  Proximity proximity = scene.make_proximity();
  SurfaceMotion motion = scene.motion_to(scene.places);
  for (double& h : motion.half_thickness) h = 1e-4;
  proximity.update(motion, *jobs);
  EXPECT_EQ(proximity.vertex_triangle().size(), 0u) << "2 cm are too far";
  for (double& h : motion.half_thickness) h = 0.0125;
  proximity.update(motion, *jobs);
  EXPECT_GT(proximity.vertex_triangle().size(), 0u) << "2 cm are within two half thicknesses of 1.25 cm";
}

TEST(Proximity, KeepsItsListsInFreeFall) {
  const auto jobs = make_serial_jobs();
  Scene scene = make_scenes().at("folded");
  Proximity proximity = scene.make_proximity();
  proximity.update(scene.motion_to(scene.places), *jobs);
  const Pairs pairs = as_set(proximity.vertex_triangle());
  const double longest_edge = proximity.longest_edge();
  for (int s = 1; s <= 60; ++s) {
    std::vector<Vec3> end = scene.places;
    for (std::size_t v = 0; v < end.size(); ++v) {
      end[v].y() -= 9.81 * s / 3600;
      end[v].x() *= 1 + 1e-5;  // and a slight stretch: a rebuilt list would have a longer longest edge
    }
    const SurfaceMotion motion = scene.motion_to(end);
    proximity.update(motion, *jobs);
    scene.places = end;
    ASSERT_EQ(proximity.longest_edge(), longest_edge) << "made anew in step " << s;
  }
  EXPECT_EQ(as_set(proximity.vertex_triangle()), pairs);
  check(proximity, scene, scene.motion_to(scene.places), "after the fall");
}

/// The listed pairs that are within the contact gap at the end, in the order of the list.
std::vector<std::array<int, 2>> close_ones(const Proximity& proximity, const std::vector<Vec3>& x) {
  std::vector<std::array<int, 2>> result;
  for (const FeaturePair& p : proximity.vertex_triangle()) {
    const auto [i, j, k] = proximity.surface().triangles[p.b];
    if (point_triangle_distance(x[p.a], x[i], x[j], x[k]).distance() <= std::min(kGap, double{p.max_gap}))
      result.push_back({p.a, p.b});
  }
  for (const FeaturePair& p : proximity.edge_edge()) {
    const auto [i, j] = proximity.surface().edges[p.a];
    const auto [k, l] = proximity.surface().edges[p.b];
    if (edge_edge_distance(x[i], x[j], x[k], x[l]).distance() <= std::min(kGap, double{p.max_gap}))
      result.push_back({p.a, p.b});
  }
  return result;
}

TEST(Proximity, WhatIsCloseDoesNotDependOnWhatCameBefore) {
  const auto jobs = make_serial_jobs();
  for (auto& [name, scene] : make_scenes()) {
    Proximity old = scene.make_proximity();
    Random random(3);
    std::vector<Vec3> velocity;
    for (std::size_t v = 0; v < scene.places.size(); ++v)
      velocity.push_back(test::random_vector(random, 0.07 * kSlack));
    for (int s = 0; s < 40; ++s) {
      std::vector<Vec3> end = scene.places;
      for (std::size_t v = 0; v < end.size(); ++v) end[v] += velocity[v];
      const SurfaceMotion motion = scene.motion_to(end);
      old.update(motion, *jobs);
      Proximity fresh = scene.make_proximity();
      fresh.update(motion, *jobs);
      EXPECT_EQ(close_ones(old, end), close_ones(fresh, end)) << name << ", step " << s;
      scene.places = end;
    }
  }
}

TEST(Proximity, ListsTheSameForAnyNumberOfThreads) {
  const auto serial = make_serial_jobs(), threads = make_jobs(3);
  Scene scene;
  Random random(6);
  for (int c = 0; c < 2; ++c) {
    scene.add_sheet(24, [&](const Vec3& p) { return Vec3(0.4 * p + test::random_vector(random, kCell)); });
  }
  Proximity a = scene.make_proximity(), b = scene.make_proximity();
  const SurfaceMotion motion = scene.motion_to(scene.places);
  a.update(motion, *serial);
  b.update(motion, *threads);
  const auto same = [](const FeaturePair& x, const FeaturePair& y) {
    return x.a == y.a && x.b == y.b && x.max_gap == y.max_gap;
  };
  EXPECT_TRUE(std::equal(a.vertex_triangle().begin(), a.vertex_triangle().end(), b.vertex_triangle().begin(),
                         b.vertex_triangle().end(), same));
  EXPECT_TRUE(std::equal(a.edge_edge().begin(), a.edge_edge().end(), b.edge_edge().begin(),
                         b.edge_edge().end(), same));
}

/// The sheets of a scene as input of a survey: floats, each with a separate origin.
class Survey {
 public:
  static constexpr double kSlackOfFew = 0.1 * kHalfThickness, kRoom = 1.1;

  explicit Survey(const Scene& scene) : sheets_(scene.sheets) {
    std::vector<Grid> grids;
    for (const Scene::Sheet& sheet : sheets_) grids.push_back(sheet.grid);
    clearance_.reset(grids);
  }

  /// Rounds positions to values that floats represent.
  std::vector<ItemPair> find_uncertain(SurfaceMotion& motion) {
    std::vector<Vec3Array> starts, ends;
    std::vector<ClothMotion> motions;
    for (const Scene::Sheet& sheet : sheets_) {
      const Vec3 origin = motion.start[sheet.first_vertex].cast<float>().cast<double>();
      for (auto* moments : {&starts, &ends}) moments->emplace_back(sheet.grid.num_particles());
      for (int i = 0; i < sheet.grid.num_particles(); ++i) {
        for (const auto& [x, to] : {std::pair(&motion.start, &starts), std::pair(&motion.end, &ends)}) {
          Vec3& place = (*x)[sheet.first_vertex + i];
          to->back().set(i, place - origin);
          place = origin + to->back().get(i);
        }
      }
      motions.push_back({nullptr, nullptr, origin, kGap});
    }
    for (std::size_t c = 0; c < motions.size(); ++c) {
      motions[c].start = &starts[c];
      motions[c].end = &ends[c];
    }
    std::vector<ItemPair> pairs;
    is_whole_ = clearance_.find_uncertain(motions, kRoom, 1'000'000, pairs);
    return pairs;
  }

  bool is_whole() const { return is_whole_; }  // false: cloth moves too far against itself

 private:
  std::vector<Scene::Sheet> sheets_;
  ClothClearance clearance_;
  bool is_whole_ = false;
};

std::map<std::string, Scene> make_sheets() {
  std::map<std::string, Scene> sheets = make_scenes();
  std::erase_if(sheets, [](const auto& s) {
    return s.second.are_meshes || s.second.num_cloth_vertices < s.second.surface.num_vertices;
  });
  return sheets;
}

/// Among the pairs that a survey leaves uncertain, the lists must contain all that brute force finds.
void check_survey(const std::string& name, const Scene& scene, const std::vector<Vec3>& end) {
  Survey survey(scene);
  SurfaceMotion motion = scene.motion_to(end);
  const std::vector<ItemPair> uncertain = survey.find_uncertain(motion);
  if (!survey.is_whole()) return;
  Proximity proximity = scene.make_proximity();
  proximity.update_among(motion, uncertain, Survey::kSlackOfFew, *make_serial_jobs());
  check(proximity, scene, motion, name, true);
}

TEST(ClothSurvey, MissesNothingAtRestAndInJumps) {
  for (const auto& [name, scene] : make_sheets()) {
    check_survey(name, scene, scene.places);
    for (const double size : {0.1 * kCell, 0.5 * kCell, 1.5 * kCell}) {
      Random random(3);
      for (int s = 0; s < 3; ++s) {
        std::vector<Vec3> end = scene.places;
        for (Vec3& p : end) p += test::random_vector(random, size);
        check_survey(name + ", jumps", scene, end);
      }
    }
  }
}

TEST(ClothSurvey, MissesNothingWhileASheetRollsUp) {
  // Also rotated and thrown, in steps that end nearer and nearer to itself.
  const auto roll = [](const Vec3& p, double radius, double turn) {
    const Vec3 rolled(radius * std::sin(p.x() / radius), radius * std::cos(p.x() / radius), p.z());
    return Vec3(rotation_from_angles_deg({turn, 20, turn}) * rolled + Vec3(0.01 * turn, 2, 0));
  };
  for (double radius = 0.25; radius > 0.03; radius *= 0.8) {
    Scene scene;
    scene.add_sheet(12, [&](const Vec3& p) { return roll(p, radius, 10); });
    std::vector<Vec3> end;
    for (const Vec3& p : scene.rest) end.push_back(roll(p, 0.8 * radius, 25));
    check_survey("radius " + std::to_string(radius), scene, end);
  }
}

TEST(ClothSurvey, IsCertainOfAnArcAndOfSheetsOneAboveTheOther) {
  Scene arc = make_scenes().at("rolled, " + std::to_string(0.12));
  SurfaceMotion falling = arc.motion_to(arc.places);
  for (Vec3& p : falling.end) p += Vec3(0.1, -0.3, 0);
  Survey survey(arc);
  EXPECT_TRUE(survey.find_uncertain(falling).empty());
  EXPECT_TRUE(survey.is_whole());

  Scene pile;
  for (const double height : {0.0, 0.01, 0.02})
    pile.add_sheet(6, [&](const Vec3& p) { return Vec3(p + Vec3(0, height, 0)); });
  SurfaceMotion together = pile.motion_to(pile.places);
  for (Vec3& p : together.end) p += Vec3(0, -0.2, 0);
  Survey of_pile(pile);
  EXPECT_TRUE(of_pile.find_uncertain(together).empty());
  EXPECT_TRUE(of_pile.is_whole());
}

TEST(ClothSurvey, GivesUpOnClothThatTurnsInsideOut) {
  const Scene scene = make_sheets().at("coincident");
  Survey survey(scene);
  SurfaceMotion motion = scene.motion_to(scene.places);
  const std::size_t all = survey.find_uncertain(motion).size();
  EXPECT_GT(all, 0u);
  EXPECT_TRUE(survey.is_whole());
  for (Vec3& p : motion.end) p = 3 * (motion.start[0] - p);
  survey.find_uncertain(motion);
  EXPECT_FALSE(survey.is_whole());
}

}  // namespace
}  // namespace weft::engine
