#include "lab/textile/hung_strip.h"

#include <algorithm>
#include <cmath>

namespace weft::engine::lab {
namespace {

constexpr double kGravity = 9.81;
constexpr double kFirstZero = 2.404826;  // of J₀
constexpr double kAmplitude = 0.02;      // of the swing [m]

Grid strip_grid(int cells) {
  return {.size_x = 1, .size_z = 0.25, .cells_x = cells, .cells_z = std::max(1, cells / 4)};
}

/// J₀, by its series.
double bessel(double x) {
  double term = 1, sum = 1;
  for (int k = 1; k < 20; ++k) {
    term *= -x * x / (4.0 * k * k);
    sum += term;
  }
  return sum;
}

/// A strip at rest, hung by the edge x = 0, with x downwards.
Specimen hang_strip(const Fabric& fabric, const Grid& grid, SpecimenMesh mesh) {
  Specimen specimen = make_rectangle(fabric, grid, mesh);
  specimen.environment.gravity = {0, -kGravity, 0};
  const auto hang = [](const Vec3& p) { return Vec3(0, -p.x(), p.z()); };
  clamp(specimen, [&](const Vec3& p) -> std::optional<Vec3> {
    if (p.x() > 1e-9) return {};
    return hang(p);
  });
  for (int i = 0; i < specimen.model->num_particles(); ++i)
    specimen.state.set_position(i, hang(specimen.rest()[i]));
  settle(specimen, 1);
  return specimen;
}

/// Mean x of the lower edge [m].
double edge_x(const Specimen& specimen, const Grid& grid) {
  double sum = 0;
  for (int j = 0; j <= grid.cells_z; ++j) sum += specimen.state.position(grid.index(grid.cells_x, j)).x();
  return sum / (grid.cells_z + 1);
}

}  // namespace

Specimen make_hammock(const Fabric& fabric, int cells, SpecimenMesh mesh) {
  Specimen specimen = make_rectangle(fabric, strip_grid(cells), mesh);
  specimen.environment.gravity = {0, -kGravity, 0};
  clamp(specimen, [](const Vec3& p) -> std::optional<Vec3> {
    if (p.x() > 1e-9 && p.x() < 1 - 1e-9) return {};
    return Vec3(0.8 * p.x(), 0, p.z());
  });
  for (int i = 0; i < specimen.model->num_particles(); ++i) {
    const Vec3& p = specimen.rest()[i];
    specimen.state.set_position(i, {0.8 * p.x(), -p.x() * (1 - p.x()), p.z()});
  }
  return specimen;
}

double measure_sag(const Specimen& specimen) {
  double sag = 0;
  for (std::size_t i = 0; i < specimen.state.x.size(); ++i)
    sag = std::max(sag, -specimen.state.position(i).y());
  return sag;
}

double measure_swing_period(const Fabric& fabric, int cells, SpecimenMesh mesh, int steps_per_second) {
  const Grid grid = strip_grid(cells);
  Specimen specimen = hang_strip(fabric, grid, mesh);
  for (int i = 0; i < specimen.model->num_particles(); ++i) {
    const double mode = bessel(kFirstZero * std::sqrt(1 - specimen.rest()[i].x()));
    specimen.state.set_position(i, specimen.state.position(i) + Vec3(kAmplitude * mode, 0, 0));
    specimen.state.v.set(i, Vec3::Zero());
  }
  specimen.state.history.step = 0;
  const auto integrator = make_newton({.iterations = 100});
  const auto jobs = make_serial_jobs();
  const double step = 1.0 / steps_per_second;
  double before = edge_x(specimen, grid), first = 0;
  int crossings = 0;  // three for a full period; half periods differ if the centre is offset
  for (double time = 0; time < 3; time += step) {
    integrator->advance(*specimen.model, specimen.environment, step, *jobs, specimen.state);
    const double now = edge_x(specimen, grid);
    if (before * now < 0) {
      const double crossing = time + step * before / (before - now);
      ++crossings;
      if (crossings == 1) first = crossing;
      if (crossings == 3) return crossing - first;
    }
    before = now;
  }
  return 0;
}

}  // namespace weft::engine::lab
