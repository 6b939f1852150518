#include "weft/world/particle_values.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "weft/error.h"

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

double degrees(double sine) { return std::asin(std::clamp(sine, -1.0, 1.0)) * 180 / std::numbers::pi; }

/// Angle between two directions, less 90° [°].
double shear_between(const Vec3& p, const Vec3& q) {
  return degrees(std::abs(p.dot(q)) / std::max(p.norm() * q.norm(), 1e-12));
}

template <class Function>
std::vector<float> over_membranes(const ClothModel& model, const ClothState& state, const Function& value) {
  Means means(model.num_particles());
  const auto& membranes = model.elements->membranes;
  for (std::size_t t = 0; t < membranes.size(); ++t) {
    const double here = value(*find_yarns(model, state, static_cast<int>(t)));
    for (const int particle : membranes[t].vertices) means.add(particle, here);
  }
  return means.take();
}

double largest_strain(const Yarns& yarns) { return std::max(yarns.warp_strain(), yarns.weft_strain()); }

std::vector<float> compute_strains(const ClothModel& model, const ClothState& state) {
  if (has_membranes(model)) return over_membranes(model, state, largest_strain);
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
  if (has_membranes(model))
    return over_membranes(model, state, [](const Yarns& yarns) { return yarns.shear(); });
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
      const double here = shear_between(state.x.get(a) - state.x.get(v), state.x.get(b) - state.x.get(v));
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

/// Forces of contacts add up at the nearest particles; a particle's area is its mass over the density.
std::vector<float> compute_pressures(const World& world, ClothId cloth) {
  const ClothModel& model = world.model(cloth);
  const int number = world.index(cloth);
  std::vector<Vec3> forces(model.mass.size(), Vec3::Zero());
  for (const ContactPoint& contact : world.contact_points()) {
    if (contact.cloth == number) forces[contact.particle] += contact.force;
    if (contact.other_cloth == number) forces[contact.other_vertex] -= contact.force;
  }
  std::vector<float> pressures;
  for (std::size_t i = 0; i < forces.size(); ++i)
    pressures.push_back(static_cast<float>(forces[i].norm() * model.material.density / model.mass[i]));
  return pressures;
}

}  // namespace

double Yarns::shear() const { return shear_between(warp, weft); }

std::optional<Yarns> find_yarns(const ClothModel& model, const ClothState& state, int triangle) {
  if (!has_membranes(model)) return std::nullopt;
  const auto& [v, rest] = model.elements->membranes[triangle];
  const Vec3 a = state.x.get(v[1]) - state.x.get(v[0]), b = state.x.get(v[2]) - state.x.get(v[0]);
  return Yarns{rest.gradient[1].x() * a + rest.gradient[2].x() * b,
               rest.gradient[1].y() * a + rest.gradient[2].y() * b};
}

ValueLabel label_of(ParticleValue value) {
  switch (value) {
    case ParticleValue::strain:
      return {"strain", "strain of threads", "%"};
    case ParticleValue::shear:
      return {"shear", "shear angle", "deg"};
    case ParticleValue::contact:
      return {"contact", "pressure of contacts", "Pa"};
    case ParticleValue::speed:
      break;
  }
  return {"speed", "speed", "m/s"};
}

std::vector<float> compute_values(ParticleValue value, const World& world, ClothId cloth) {
  switch (value) {
    case ParticleValue::strain:
      return compute_strains(world.model(cloth), world.state(cloth));
    case ParticleValue::shear:
      return compute_shears(world.model(cloth), world.state(cloth));
    case ParticleValue::contact:
      return compute_pressures(world, cloth);
    case ParticleValue::speed:
      break;
  }
  return compute_speeds(world.state(cloth));
}

}  // namespace weft::engine
