#include "weft/world/particle_values.h"

#include <cmath>
#include <numbers>

#include "weft/error.h"
#include "weft/forces/membrane.h"

namespace weft::engine {
namespace {

/// Means of values at particles.
class Means {
 public:
  explicit Means(int num_particles) : sums_(num_particles), counts_(num_particles) {}

  void add(int particle, double value) {
    sums_[particle] += value;
    ++counts_[particle];
  }

  std::vector<float> take() const {
    std::vector<float> means;
    for (std::size_t i = 0; i < sums_.size(); ++i)
      means.push_back(static_cast<float>(counts_[i] == 0 ? 0 : sums_[i] / counts_[i]));
    return means;
  }

 private:
  std::vector<double> sums_;
  std::vector<int> counts_;
};

bool has_membranes(const ClothModel& model) { return model.elements && !model.elements->membranes.empty(); }

double strain_of(const Vec3& green) { return 100 * (std::sqrt(1 + 2 * std::max(green.x(), green.y())) - 1); }

double degrees(double sine) { return std::asin(std::clamp(sine, -1.0, 1.0)) * 180 / std::numbers::pi; }

double shear_of(const Vec3& green) {
  const double stretches_sq = (1 + 2 * green.x()) * (1 + 2 * green.y());
  return degrees(std::abs(green.z()) / std::sqrt(std::max(stretches_sq, 1e-12)));
}

template <class Function>
std::vector<float> over_membranes(const ClothModel& model, const ClothState& state, const Function& value) {
  Means means(model.num_particles());
  for (const auto& [v, rest] : model.elements->membranes) {
    const double here =
        value(membrane_strain(rest, {state.x.get(v[0]), state.x.get(v[1]), state.x.get(v[2])}));
    for (const int particle : v) means.add(particle, here);
  }
  return means.take();
}

std::vector<float> compute_strains(const ClothModel& model, const ClothState& state) {
  if (has_membranes(model)) return over_membranes(model, state, strain_of);
  Means means(model.num_particles());
  for (const Spring& s : model.topology->springs) {
    if (s.kind != SpringKind::structural) continue;
    const double strain = 100 * ((state.x.get(s.j) - state.x.get(s.i)).norm() / s.rest_length - 1);
    means.add(s.i, strain);
    means.add(s.j, strain);
  }
  return means.take();
}

/// Angles between structural springs of both axes of a grid, at each corner of each cell's triangles.
std::vector<float> compute_shears(const ClothModel& model, const ClothState& state) {
  if (has_membranes(model)) return over_membranes(model, state, shear_of);
  if (!model.topology->grid)
    throw InputError("shear is the angle between warp and weft: it requires a fabric, or a grid");
  Means means(model.num_particles());
  const std::vector<Vec3>& rest = model.topology->mesh.positions;
  for (const Triangle& triangle : model.topology->mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      const int v = triangle[corner], a = triangle[(corner + 1) % 3], b = triangle[(corner + 2) % 3];
      const bool is_right =
          std::abs((rest[a] - rest[v]).dot(rest[b] - rest[v])) < 1e-9 * (rest[a] - rest[v]).squaredNorm();
      if (!is_right) continue;
      const Vec3 p = state.x.get(a) - state.x.get(v), q = state.x.get(b) - state.x.get(v);
      const double here = degrees(std::abs(p.dot(q)) / std::max(p.norm() * q.norm(), 1e-12));
      for (const int particle : triangle) means.add(particle, here);
    }
  }
  return means.take();
}

std::vector<float> compute_speeds(const ClothState& state) {
  std::vector<float> speeds;
  for (std::size_t i = 0; i < state.v.size(); ++i)
    speeds.push_back(static_cast<float>(state.v.get(i).norm()));
  return speeds;
}

}  // namespace

ValueLabel label_of(ParticleValue value) {
  switch (value) {
    case ParticleValue::strain:
      return {"strain of threads", "%"};
    case ParticleValue::shear:
      return {"shear angle", "deg"};
    case ParticleValue::speed:
      break;
  }
  return {"speed", "m/s"};
}

std::vector<float> compute_values(ParticleValue value, const ClothModel& model, const ClothState& state) {
  switch (value) {
    case ParticleValue::strain:
      return compute_strains(model, state);
    case ParticleValue::shear:
      return compute_shears(model, state);
    case ParticleValue::speed:
      break;
  }
  return compute_speeds(state);
}

}  // namespace weft::engine
