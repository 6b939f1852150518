#include "lab/contact/collision.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "lab/benchmarks/machine.h"
#include "lab/contact/response.h"
#include "lab/contact/uniform_grid.h"
#include "weft/core/random.h"
#include "weft/core/simd.h"
#include "weft/geometry/aabb_tree.h"
#include "weft/mesh/grid.h"

namespace weft::engine::lab {
namespace {

constexpr double kSpacing = 0.01;    // of particles: about an edge [m]
constexpr double kLayerGap = 0.003;  // [m]
constexpr double kMargin = 0.002;    // around triangles: half a thickness of 1 mm, plus the Verlet slack [m]
constexpr double kCell = 2 * kSpacing;
constexpr double kTurn = 6.283185307179586;

/// A sheet in two alternating poses, so that consecutive queries have different boxes.
struct Shape {
  std::string name;
  std::vector<Triangle> triangles;
  std::vector<Vec3> poses[2];
};

double wave(double place, double length) { return std::sin(kTurn * place / length); }

/// A gently wavy sheet: waves of 60 cm, 2 cm high.
Vec3 rest_place(double x, double z, int pose) { return {x, 0.02 * wave(x + 0.3 * z + 0.01 * pose, 0.6), z}; }

/// The same in eight layers, a zigzag along x.
Vec3 folded_place(double x, double z, double width, int pose) {
  constexpr int kLayers = 8;
  const double length = width / kLayers;
  const int layer = std::min(static_cast<int>(x / length), kLayers - 1);
  const double along = layer % 2 == 0 ? x - layer * length : (layer + 1) * length - x;
  const double shift = 0.37 * kSpacing * layer;  // so that particles of different layers are not aligned
  return rest_place(along, z + shift, pose) + Vec3(0, kLayerGap * layer, 0);
}

/// A crumpled sheet: waves of random directions, with the size of the sheet crumpled into a ball.
class Crumple {
 public:
  explicit Crumple(double width) {
    const double radius = 0.3 * kSpacing * std::pow(width / kSpacing, 2.0 / 3);
    Random random(11);
    for (Wave& w : waves_) {
      const double angle = random.uniform(0, kTurn), steepness = random.uniform(0.5, 1);
      w.height = radius * random.uniform(0.3, 1);
      w.along_x = steepness * std::cos(angle) / w.height;
      w.along_z = steepness * std::sin(angle) / w.height;
      w.phase = random.uniform(0, kTurn);
    }
  }

  Vec3 place(double x, double z, int pose) const {
    Vec3 p = Vec3::Zero();
    for (int k = 0; k < kNumWaves; ++k) {
      const Wave& w = waves_[k];
      p[k % 3] += w.height * std::sin(w.along_x * x + w.along_z * z + w.phase + 0.01 * pose);
    }
    return p;
  }

 private:
  struct Wave {
    double height, along_x, along_z, phase;
  };
  static constexpr int kNumWaves = 6;
  Wave waves_[kNumWaves];
};

Shape make_shape(const std::string& name, int num_triangles) {
  const int cells = std::max(1, static_cast<int>(std::lround(std::sqrt(num_triangles / 2.0))));
  const double width = cells * kSpacing;
  const TriangleMesh mesh = build_grid_mesh(
      {.size_x = width, .size_z = width, .cells_x = cells, .cells_z = cells}, GridDiagonals::alternating);
  const Crumple crumple(width);
  Shape shape{name, mesh.triangles, {}};
  for (const int pose : {0, 1}) {
    for (const Vec3& p : mesh.positions) {
      const double x = p.x(), z = p.z();
      shape.poses[pose].push_back(name == "rest"     ? rest_place(x, z, pose)
                                  : name == "folded" ? folded_place(x, z, width, pose)
                                                     : crumple.place(x, z, pose));
    }
  }
  return shape;
}

Aabb merged(const std::vector<Aabb>& boxes, const Triangle& t) {
  Aabb box = boxes[t[0]];
  box.merge(boxes[t[1]]);
  box.merge(boxes[t[2]]);
  return box;
}

std::vector<Aabb> triangle_boxes(const Shape& shape, int pose) {
  std::vector<Aabb> at_vertices, boxes;
  for (const Vec3& p : shape.poses[pose]) at_vertices.push_back(make_aabb(p, p, kMargin));
  for (const Triangle& t : shape.triangles) boxes.push_back(merged(at_vertices, t));
  return boxes;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

template <class Measured>
double median_time(double seconds, const Measured& measured) {
  std::vector<double> times;
  for (const double begin = seconds_now(); times.empty() || seconds_now() - begin < seconds;) {
    const double start = seconds_now();
    measured();
    times.push_back(seconds_now() - start);
  }
  return median(times);
}

// ---- The tree ----

struct TreeTimes {
  double build = 0, refit = 0, query = 0, both = 0;  // [s]
};

/// Refits the tree: positions → boxes of vertices → boxes of triangles → tree.
void refit(const Shape& shape, int pose, JobSystem& jobs, std::vector<Aabb>& vertex_boxes, AabbTree& tree) {
  constexpr int kGrain = 4096;
  const std::vector<Vec3>& x = shape.poses[pose];
  vertex_boxes.resize(x.size());
  parallel_for(jobs, static_cast<int>(x.size()), kGrain, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) vertex_boxes[v] = make_aabb(x[v], x[v], kMargin);
  });
  tree.refit([&](int t) { return merged(vertex_boxes, shape.triangles[t]); }, jobs);
}

/// At return the tree is in pose 0, and `search` has its pairs.
TreeTimes time_tree(const Shape& shape, JobSystem& jobs, double seconds, AabbTree& tree, PairSearch& search) {
  TreeTimes times;
  std::vector<Aabb> vertex_boxes = triangle_boxes(shape, 0);
  times.build = median_time(seconds / 4, [&] { tree.build(vertex_boxes, shape.triangles, jobs); });
  std::vector<double> refits, queries, both;
  int pose = 1;
  for (const double begin = seconds_now(); refits.size() < 4 || pose == 1 || seconds_now() - begin < seconds;
       pose = 1 - pose) {
    const double start = seconds_now();
    refit(shape, pose, jobs, vertex_boxes, tree);
    const double middle = seconds_now();
    tree.find_self_pairs(jobs, search);
    const double end = seconds_now();
    refits.push_back(middle - start);
    queries.push_back(end - middle);
    both.push_back(end - start);
  }
  refit(shape, 0, jobs, vertex_boxes, tree);
  tree.find_self_pairs(jobs, search);
  times.refit = median(refits);
  times.query = median(queries);
  times.both = median(both);
  return times;
}

/// Number of scalar comparisons per comparison of two boxes in the tree, counted exactly [1].
double comparisons_per_box_pair(const AabbTree& tree, JobSystem& jobs) {
  PairSearch search;
  search.counts_comparisons = true;
  tree.find_self_pairs(jobs, search);
  return static_cast<double>(search.num_comparisons) /
         static_cast<double>(std::max<std::int64_t>(1, search.num_box_pairs));
}

// ---- Its peers ----

bool share_vertex(const Triangle& a, const Triangle& b) {
  return std::any_of(a.begin(), a.end(), [&](int v) { return v == b[0] || v == b[1] || v == b[2]; });
}

void find_by_brute_force(const std::vector<Aabb>& boxes, const std::vector<Triangle>& triangles,
                         std::vector<ItemPair>& pairs) {
  pairs.clear();
  for (int a = 0; a < static_cast<int>(boxes.size()); ++a) {
    for (int b = a + 1; b < static_cast<int>(boxes.size()); ++b) {
      if (boxes[a].overlaps(boxes[b]) && !share_vertex(triangles[a], triangles[b])) pairs.push_back({a, b});
    }
  }
}

struct Peers {
  double grid = 0;              // [s]
  std::optional<double> brute;  // [s]
  std::vector<ItemPair> pairs;  // sorted
  bool agree = true;
};

Peers measure_peers(const Shape& shape, double seconds) {
  constexpr std::size_t kMaxForBruteForce = 9000;
  Peers peers;
  const std::vector<Aabb> boxes = triangle_boxes(shape, 0);
  UniformGrid grid;
  PairSearch search;
  const auto run_grid = [&] {
    grid.fill(boxes, kCell);
    grid.find_self_pairs(boxes, shape.triangles, search);
  };
  run_grid();
  peers.grid = median_time(seconds, run_grid);
  peers.pairs = search.pairs;
  std::sort(peers.pairs.begin(), peers.pairs.end());
  if (boxes.size() <= kMaxForBruteForce) {
    std::vector<ItemPair> pairs;
    peers.brute = median_time(seconds / 4, [&] { find_by_brute_force(boxes, shape.triangles, pairs); });
    peers.agree = pairs == peers.pairs;
  }
  return peers;
}

bool bench_shape(const std::string& name, int size, const CollisionBenchOptions& options) {
  const Shape shape = make_shape(name, size);
  const Peers peers = measure_peers(shape, options.seconds);
  bool is_right = peers.agree;
  std::vector<ItemPair> first;
  for (const int threads : options.threads) {
    const auto jobs = make_jobs(threads);
    AabbTree tree;
    PairSearch search;
    const TreeTimes times = time_tree(shape, *jobs, options.seconds, tree, search);
    if (first.empty()) first = search.pairs;
    is_right &= search.pairs == first;  // also in the same order
    const double found = static_cast<double>(search.pairs.size());
    const double tested = static_cast<double>(search.num_box_pairs);
    fmt::print(
        "{:<7} {:>8} {:>2} {:>8.2f} {:>7.3f} {:>7.3f} {:>8.3f} {:>7.1f} {:>8.1f} {:>5.2f} {:>7.0f} {:>7.1f}",
        name, shape.triangles.size(), threads, 1e3 * times.build, 1e3 * times.refit, 1e3 * times.query,
        1e3 * times.both, 1e-3 * found, 1e-3 * tested, comparisons_per_box_pair(tree, *jobs),
        1e-6 * tested / times.query, 1e-6 * found / times.both);
    if (threads == 1) {
      fmt::print(" {:>7.1f}", peers.grid / times.both);
      if (peers.brute) fmt::print(" {:>7.0f}", *peers.brute / times.both);
    }
    fmt::print("\n");
    std::fflush(stdout);
  }
  std::sort(first.begin(), first.end());
  is_right &= first == peers.pairs;
  if (!is_right)
    fmt::print("ERROR: tree, grid and brute force, or numbers of threads, find different pairs\n");
  return is_right;
}

}  // namespace

bool bench_collision(const CollisionBenchOptions& options) {
  fmt::print(
      "SIMD {}, clock {:.2f} GHz. Sheets of cells of {:.0f} mm, boxes {:.0f} mm beyond each triangle.\n",
      to_string(simd_level()), 1e-9 * measure_clock(), 1e3 * kSpacing, 1e3 * kMargin);
  fmt::print(
      "Times are medians in ms. Both: refit and query of all pairs without a common vertex. cmp: scalar\n"
      "comparisons per compared pair of boxes. Mbox/s: compared pairs of boxes per second of a query. M/s: pairs\n"
      "found per second of both. Grid, brute: their time over the tree's, on one thread.\n\n");
  fmt::print("{:<7} {:>8} {:>2} {:>8} {:>7} {:>7} {:>8} {:>7} {:>8} {:>5} {:>7} {:>7} {:>7} {:>7}\n", "shape",
             "size", "T", "build", "refit", "query", "both", "k found", "k boxes", "cmp", "Mbox/s", "M/s",
             "grid ×", "brute ×");
  bool is_right = true;
  for (const std::string name : {"rest", "folded", "heap"}) {
    for (const int size : options.sizes) is_right &= bench_shape(name, size, options);
  }
  bench_response(options.cells, options.seconds);
  return is_right;
}

}  // namespace weft::engine::lab
