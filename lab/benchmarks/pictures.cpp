#include "lab/benchmarks/pictures.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "lab/benchmarks/machine.h"
#include "weft/fabric.h"
#include "weft/mesh/grid.h"
#include "weft/render/renderer.h"

namespace weft::engine::lab {
namespace {

/// A sheet over a ball, without simulation: lies on the ball, and hangs in waves around it.
DrawnMesh make_draped_sheet(int num_triangles) {
  const int cells = std::max(1, static_cast<int>(std::lround(std::sqrt(num_triangles / 2.0))));
  const Grid grid{.size_x = 1, .size_z = 1, .cells_x = cells, .cells_z = cells};
  DrawnMesh sheet;
  const TriangleMesh flat = build_grid_mesh(grid, GridDiagonals::alternating);
  sheet.triangles = flat.triangles;
  sheet.look = {Look::Kind::fabric, {0.10, 0.16, 0.30}, 0, find_fabric_preset("denim").look};
  for (const Vec3& p : flat.positions) {
    const double x = p.x() - 0.5, z = p.z() - 0.5, r = std::hypot(x, z), angle = std::atan2(z, x);
    const double over = std::min(r, 0.3), beyond = std::max(0.0, r - 0.3);
    const double y = 0.7 - over * over / 0.6 - beyond + 0.2 * beyond * std::sin(9 * angle);
    const double out = 0.3 * std::sin(std::min(r, 0.47) / 0.3) + 0.15 * beyond * std::cos(9 * angle);
    for (const double c : {out * std::cos(angle), y, out * std::sin(angle)})
      sheet.positions.push_back(static_cast<float>(c));
    for (const double c : {p.x(), p.z()}) sheet.fabric_coordinates.push_back(static_cast<float>(c));
  }
  return sheet;
}

Picture make_picture(int num_triangles) {
  Picture picture;
  picture.meshes.push_back(make_draped_sheet(num_triangles));
  DrawnMesh ball;
  const TriangleMesh sphere = make_sphere_mesh({0, 0.4, 0}, 0.295, 32);
  ball.triangles = sphere.triangles;
  for (const Vec3& p : sphere.positions) {
    for (const double c : p) ball.positions.push_back(static_cast<float>(c));
  }
  picture.meshes.push_back(std::move(ball));
  picture.ground = 0;
  picture.camera.target = {0, 0.4, 0};
  picture.camera.distance = 2;
  return picture;
}

struct Cost {
  double wall_ms, cpu_ms;  // medians; processor time of all threads
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Cost measure(const Picture& picture, PictureSize size, const RenderSettings& settings, int repeats) {
  Renderer renderer(make_offscreen_device(), settings);
  renderer.draw(picture, size);
  std::vector<double> wall, cpu;
  for (int k = 0; k < repeats; ++k) {
    const double start = seconds_now();
    const std::clock_t cpu_start = std::clock();
    renderer.draw(picture, size);
    wall.push_back(1000 * (seconds_now() - start));
    cpu.push_back(1000 * static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC);
  }
  return {median(wall), median(cpu)};
}

}  // namespace

void bench_pictures(const PictureBenchOptions& options) {
  const double start = seconds_now();
  const Picture first = make_picture(options.triangles.empty() ? 32768 : options.triangles[0]);
  Renderer(make_offscreen_device()).draw(first, options.size);
  fmt::print("first picture {:.0f} ms after the start, shaders compiled\n\n", 1000 * (seconds_now() - start));
  fmt::print("{}x{}: wall ms (processor ms of all threads) per picture, median of {}\n\n", options.size.width,
             options.size.height, options.repeats);
  fmt::print("{:>10} {:>14} {:>14} {:>14} {:>14}\n", "triangles", "all", "no shadows", "no occlusion",
             "one sample");
  for (const int triangles : options.triangles) {
    const Picture picture = make_picture(triangles);
    fmt::print("{:>10}", picture.meshes[0].triangles.size());
    for (const RenderSettings& settings :
         {RenderSettings{}, RenderSettings{.shadow_size = 0}, RenderSettings{.occlusion = false},
          RenderSettings{.samples = 1}}) {
      const Cost cost = measure(picture, options.size, settings, options.repeats);
      fmt::print(" {:>14}", fmt::format("{:.0f} ({:.0f})", cost.wall_ms, cost.cpu_ms));
      std::fflush(stdout);
    }
    fmt::print("\n");
  }
}

}  // namespace weft::engine::lab
