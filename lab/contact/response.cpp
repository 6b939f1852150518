#include "lab/contact/response.h"

#include <fmt/core.h>

#include <algorithm>

#include "lab/benchmarks/machine.h"
#include "weft/contact/contact_system.h"
#include "weft/core/angle.h"
#include "weft/geometry/aabb_tree.h"
#include "weft/geometry/distance.h"

namespace weft::engine::lab {
namespace {

constexpr double kThickness = 1e-3;              // [m]
constexpr double kLayerGap = 1.02 * kThickness;  // only neighbouring sheets are close [m]
constexpr double kSpacing = 0.01;                // of the sheets' particles [m]
constexpr double kStep = 1.0 / 240;              // [s]

/// A stack of sheets of 1 mm on the floor, each rotated against the one below.
struct Stack {
  std::shared_ptr<const ClothModel> model;
  std::vector<ClothState> states;
  std::vector<char> is_pinned;
  std::vector<Collider> floor = {{.name = "floor", .shape = Plane{}}};
  std::unique_ptr<JobSystem> jobs = make_serial_jobs();
  ContactSystem contact;
};

/// Layer `layer` of a stack; another `stretch` than 1 changes the width, so that everything has moved.
ClothState make_layer(const ClothTopology& topology, int layer, double stretch) {
  constexpr double kTurn_deg = 17;
  const auto [s, c] = sin_cos_deg(kTurn_deg * layer);
  const double middle = topology.grid->size_x / 2;
  std::vector<Vec3> positions;
  for (const Vec3& p : topology.mesh.positions) {
    const double x = stretch * (p.x() - middle), z = stretch * (p.z() - middle);
    positions.emplace_back(c * x - s * z, 0.5 * kThickness + layer * kLayerGap, s * x + c * z);
  }
  return make_state(positions);
}

void build_stack(int layers, int cells, Stack& stack) {
  const double side = kSpacing * cells;
  stack.model = build_cloth_model(
      build_grid_topology({.size_x = side, .size_z = side, .cells_x = cells, .cells_z = cells},
                          SpringModel::simplified),
      ClothMaterial{.thickness = kThickness});
  for (int k = 0; k < layers; ++k) stack.states.push_back(make_layer(*stack.model->topology, k, 1));
  stack.is_pinned.assign(stack.model->num_particles(), 0);
}

/// Time of a step under gravity without springs: contact only [s].
double time_step(Stack& stack, double stretch) {
  std::vector<ContactCloth> cloths;
  for (std::size_t k = 0; k < stack.states.size(); ++k) {
    stack.states[k] = make_layer(*stack.model->topology, static_cast<int>(k), stretch);
    cloths.push_back({stack.model.get(), &stack.states[k], &stack.is_pinned});
  }
  double begin = seconds_now();
  stack.contact.begin_step(cloths, stack.floor, {.time = kStep, .step = kStep}, *make_serial_jobs());
  double seconds = seconds_now() - begin;
  const Vec3 fall(0, -9.81 * kStep, 0);
  for (ClothState& state : stack.states) {
    for (std::size_t i = 0; i < stack.is_pinned.size(); ++i) {
      state.v.set(i, fall);
      state.set_position(i, state.position(i) + kStep * fall);
    }
  }
  begin = seconds_now();
  stack.contact.read_solution({});
  stack.contact.find_violations(*stack.jobs);
  stack.contact.project_contacts(*stack.jobs);
  return seconds + seconds_now() - begin;
}

/// Median over steps that cycle through `stretches`.
double measure(Stack& stack, std::vector<double> stretches, double seconds) {
  for (const double stretch : stretches) time_step(stack, stretch);
  std::vector<double> times;
  for (const double begin = seconds_now(); times.empty() || seconds_now() - begin < seconds;) {
    double sum = 0;
    for (const double stretch : stretches) sum += time_step(stack, stretch);
    times.push_back(sum / static_cast<double>(stretches.size()));
  }
  std::nth_element(times.begin(), times.begin() + times.size() / 2, times.end());
  return times[times.size() / 2];
}

/// Number of close pairs, within twice the thickness: particles and floor, particles and interiors of
/// triangles of other sheets, crossing edges. Counted with the tree, independently of the contact system.
std::int64_t count_close_pairs(const Stack& stack) {
  constexpr double kReach = 2 * kThickness;
  std::vector<Vec3> x;
  Surface surface;
  const TriangleMesh& mesh = stack.model->topology->mesh;
  for (const ClothState& state : stack.states) {
    surface.add(mesh.triangles, mesh.num_vertices());
    for (int i = 0; i < mesh.num_vertices(); ++i) x.push_back(state.position(i));
  }
  std::vector<Aabb> boxes;
  for (const auto& [i, j, k] : surface.triangles) {
    boxes.push_back(
        make_aabb(x[i].cwiseMin(x[j]).cwiseMin(x[k]), x[i].cwiseMax(x[j]).cwiseMax(x[k]), kReach / 2));
  }
  AabbTree tree;
  PairSearch search;
  tree.build(boxes, surface.triangles, *stack.jobs);
  tree.find_self_pairs(*stack.jobs, search);

  std::int64_t count = mesh.num_vertices();  // the lowest sheet's, on the floor
  const auto is_over = [&](int v, const Triangle& t) {
    const auto d = point_triangle_distance(x[v], x[t[0]], x[t[1]], x[t[2]]);
    return d.region == TriangleRegion::face && d.distance() < kReach;
  };
  const auto cross = [&](int e, int f) {
    const auto& [i, j] = surface.edges[e];
    const auto& [k, l] = surface.edges[f];
    const auto d = edge_edge_distance(x[i], x[j], x[k], x[l]);
    return d.region_a == EdgeRegion::interior && d.region_b == EdgeRegion::interior && d.distance() < kReach;
  };
  const int per_sheet = mesh.num_triangles();
  for (const auto& [a, b] : search.pairs) {
    if (a / per_sheet == b / per_sheet) continue;
    const Surface::OwnedFeatures &own_a = surface.owned[a], &own_b = surface.owned[b];
    for (const int v : own_a.vertex) count += v >= 0 && is_over(v, surface.triangles[b]);
    for (const int v : own_b.vertex) count += v >= 0 && is_over(v, surface.triangles[a]);
    for (const int e : own_a.edge) {
      for (const int f : own_b.edge) count += e >= 0 && f >= 0 && cross(e, f);
    }
  }
  return count;
}

}  // namespace

void bench_response(int cells, double seconds) {
  fmt::print(
      "\nResponse: stacks of sheets of {0}×{0} cells on a floor, one step of {1:.1f} ms on one thread. Kept: "
      "the\nlists of near pairs are still valid; searched: they are rebuilt. µs: per close pair.\n\n",
      cells, 1e3 * kStep);
  fmt::print("{:>6} {:>10} {:>11} {:>9} {:>9} {:>12} {:>9}\n", "sheets", "triangles", "close pairs",
             "kept ms", "µs/pair", "searched ms", "µs/pair");
  for (const int layers : {1, 2, 4, 8}) {
    Stack stack;
    build_stack(layers, cells, stack);
    const double pairs = static_cast<double>(count_close_pairs(stack));
    const double kept = measure(stack, {1.0}, seconds), searched = measure(stack, {1.0, 1.02}, seconds);
    fmt::print("{:>6} {:>10} {:>11.0f} {:>9.2f} {:>8.2f} {:>12.2f} {:>8.2f}\n", layers,
               layers * stack.model->topology->mesh.num_triangles(), pairs, 1e3 * kept, 1e6 * kept / pairs,
               1e3 * searched, 1e6 * searched / pairs);
    std::fflush(stdout);
  }
}

}  // namespace weft::engine::lab
