#include "lab/contact/contact_experiments.h"

#include <algorithm>
#include <cmath>

#include "weft/forces/spring.h"
#include "weft/world/measures.h"
#include "weft/world/world.h"

namespace weft::engine::lab {
namespace {

constexpr double kGravity = 9.81;
constexpr double kSliding = 5e-3;  // slower contacts may stick [m/s]
constexpr double kPi = 3.14159265358979323846;
const ClothMaterial kSoft{.structural = 100, .shear = 30, .bend = 0.2, .damping = 1e-3, .friction = 0.3};

double radians(double angle_deg) { return angle_deg * kPi / 180; }

World make_world(const ContactExperiment& setup) {
  World world;
  world.set_integrator({.integrator = setup.integrator});
  world.track_contacts(true);
  return world;
}

/// Adds a sheet with its middle at the origin, then rotates it and moves it to `middle`.
ClothId add_sheet(World& world, const std::string& name, int cells, double size, const Mat3& turn,
                  const Vec3& middle, const ClothMaterial& material = kSoft,
                  const Vec3& velocity = Vec3::Zero()) {
  const auto topology = build_grid_topology(
      {.size_x = size, .size_z = size, .cells_x = cells, .cells_z = cells}, SpringModel::alternating);
  std::vector<Vec3> positions;
  for (const Vec3& p : topology->mesh.positions)
    positions.push_back(middle + turn * (p - Vec3(size / 2, 0, size / 2)));
  return world.add_cloth({.name = name,
                          .topology = topology,
                          .material = material,
                          .positions = positions,
                          .velocity = velocity});
}

/// Pins all particles, which follow the motion.
void pin_all(World& world, ClothId cloth, const RigidMotion& motion) {
  Pin pin{.motion = motion};
  for (int i = 0; i < world.model(cloth).num_particles(); ++i) pin.particles.push_back(i);
  world.set_pins(cloth, {pin});
}

Vec3 middle_of(const World& world, ClothId cloth) {
  return compute_center_of_mass(world.model(cloth), world.state(cloth));
}

/// Angular momentum about the vertical through the origin [kg·m²/s].
double angular_momentum_of(const World& world, ClothId cloth) {
  return compute_angular_momentum(world.model(cloth), world.state(cloth), Vec3::Zero()).y();
}

double mass_of(const World& world, ClothId cloth) {
  double mass = 0;
  for (const double m : world.model(cloth).mass) mass += m;
  return mass;
}

/// ⟨r⟩/⟨r²⟩ of a square about its middle: a (√2 + asinh 1)/6 over a²/6 [1/m].
double square_lever(double size) { return (std::sqrt(2.0) + std::asinh(1.0)) / size; }

/// Constant acceleration from rest at `start`, as by implicit Euler: a h² n (n + 1)/2 after n steps.
/// pose_at(distance) is the key frame, without its time.
template <class PoseAt>
RigidMotion accelerate(const ContactExperiment& setup, double start, double seconds, double acceleration,
                       const PoseAt& pose_at) {
  const double h = 1.0 / setup.steps_per_second;
  std::vector<KeyFrame> keys;
  for (int n = 0; n <= std::lround(seconds / h); ++n) {
    KeyFrame key = pose_at(0.5 * acceleration * h * h * n * (n + 1));
    key.time = start + n * h;
    keys.push_back(key);
  }
  return RigidMotion(keys);
}

/// Velocity of the other body at a contact [m/s].
Vec3 other_velocity(const World& world, const ContactPoint& contact, double step) {
  if (contact.other_cloth >= 0)
    return world.state(world.cloth(contact.other_cloth)).v.get(contact.other_vertex);
  const Collider& collider = world.colliders()[contact.collider];
  const Vec3 center = pivot(collider.shape);
  const Pose before = collider.motion.at(world.time() - step), now = collider.motion.at(world.time());
  return (contact.position - apply(before, center, apply_inverse(now, center, contact.position))) / step;
}

template <class AfterStep>
void run(World& world, const ContactExperiment& setup, double seconds, const AfterStep& after_step) {
  const int num_steps = static_cast<int>(std::lround(seconds * setup.steps_per_second));
  for (int s = 0; s < num_steps; ++s) {
    world.step(1.0 / setup.steps_per_second);
    after_step();
  }
}

}  // namespace

FrictionAudit& FrictionAudit::operator+=(const FrictionAudit& next) {
  sliding += next.sliding;
  tangential += next.tangential;
  limit += next.limit;
  torque += next.torque;
  torque_limit += next.torque_limit;
  return *this;
}

FrictionAudit audit_friction(const World& world, double step, double friction, const Axis& axis) {
  FrictionAudit audit;
  for (const ContactPoint& contact : world.contact_points()) {
    const auto tangent = [&](const Vec3& v) -> Vec3 { return v - v.dot(contact.normal) * contact.normal; };
    const Vec3 velocity = world.state(world.cloth(contact.cloth)).v.get(contact.particle);
    if (tangent(velocity - other_velocity(world, contact, step)).norm() < kSliding) continue;
    const Vec3 force = tangent(contact.force), lever = contact.position - axis.point;
    const double most = friction * contact.force.dot(contact.normal);
    ++audit.sliding;
    audit.tangential += force.norm();
    audit.limit += most;
    audit.torque += lever.cross(force).dot(axis.direction);
    audit.torque_limit += most * lever.cross(axis.direction).norm();
  }
  return audit;
}

namespace {

/// Runs and audits a sheet that friction turns about the vertical through the origin. Returns the torque from
/// its angular momentum, over the audit's limit; 0 if nothing slides [1].
template <class AfterStep>
double watch_turning(World& world, const ContactExperiment& setup, double seconds, ClothId sheet,
                     double friction, FrictionAudit& audit, const AfterStep& after_step) {
  const double step = 1.0 / setup.steps_per_second, before = angular_momentum_of(world, sheet);
  run(world, setup, seconds, [&] {
    audit += audit_friction(world, step, friction);
    after_step();
  });
  if (audit.torque_limit == 0) return 0;
  return (angular_momentum_of(world, sheet) - before) / (step * audit.torque_limit);
}

}  // namespace

Slide slide_on_incline(const ContactExperiment& setup, double angle_deg, double friction) {
  constexpr double kSeconds = 0.4;
  const Mat3 tilt = rotation_from_angles_deg({0, 0, angle_deg});
  World world = make_world(setup);
  world.add_collider({"slope", Plane{Vec3::Zero(), tilt * Vec3::UnitY()}, friction, {}});
  const ClothId sheet =
      add_sheet(world, "sheet", setup.cells, 0.4, tilt, tilt * Vec3(0, kSoft.thickness / 2, 0));
  const Vec3 before = middle_of(world, sheet);
  run(world, setup, kSeconds, [] {});
  const double way = -(middle_of(world, sheet) - before).dot(tilt * Vec3::UnitX());
  const double angle = radians(angle_deg);
  // In implicit and semi-implicit Euler, n steps from rest cover a h² n (n + 1) / 2.
  const double h = 1.0 / setup.steps_per_second, n = std::round(kSeconds / h);
  return {way / (0.5 * h * h * n * (n + 1)),
          std::max(0.0, kGravity * (std::sin(angle) - friction * std::cos(angle)))};
}

namespace {

/// A tube of pinned particles around the z axis that turns with the motion.
void add_tube(World& world, const ClothMaterial& material, double radius, double width,
              const RigidMotion& motion) {
  const Grid grid{.size_x = 2 * kPi * radius, .size_z = width, .cells_x = 80, .cells_z = 12};
  const auto topology = build_grid_topology(grid, SpringModel::alternating);
  std::vector<Vec3> positions;
  for (const Vec3& p : topology->mesh.positions) {
    const double angle = p.x() / radius;
    positions.push_back({radius * std::sin(angle), -radius * std::cos(angle), p.z() - width / 2});
  }
  const ClothId tube =
      world.add_cloth({.name = "tube", .topology = topology, .material = material, .positions = positions});
  pin_all(world, tube, motion);
}

}  // namespace

Capstan pull_over_drum(const ContactExperiment& setup, double friction, Drum drum) {
  constexpr double kRadius = 0.1, kHang = 0.1, kWidth = 0.08, kSpeed_deg = 60, kTension = 1.02;
  ClothMaterial material = kSoft;
  material.friction = friction;
  material.structural = 500;
  material.shear = 0;
  material.bend = 0;
  const double reach = kRadius + (drum == Drum::cloth ? material.thickness : material.thickness / 2);
  const double length = (kPi * reach + 2 * kHang) / kTension;
  const Grid grid{.size_x = length, .size_z = kWidth, .cells_x = 3 * setup.cells, .cells_z = 4};
  const auto topology = build_grid_topology(grid, SpringModel::alternating);
  std::vector<Vec3> positions;
  for (const Vec3& p : topology->mesh.positions) {
    const double s = kTension * p.x() - kHang, angle = std::clamp(s / reach, 0.0, kPi);
    const double below = std::min(0.0, s) + std::min(0.0, kPi * reach - s);
    positions.push_back({-reach * std::cos(angle), reach * std::sin(angle) + below, p.z() - kWidth / 2});
  }
  World world = make_world(setup);
  world.set_gravity(Vec3::Zero());
  const RigidMotion motion({{.time = 0}, {.time = 100, .angles_deg = {0, 0, -100 * kSpeed_deg}}});
  if (drum == Drum::cloth)
    add_tube(world, material, kRadius, 2 * kWidth, motion);
  else
    world.add_collider({"drum", Capsule{Vec3(0, 0, -0.3), Vec3(0, 0, 0.3), kRadius}, friction, motion});
  const ClothId strip =
      world.add_cloth({.name = "strip", .topology = topology, .material = material, .positions = positions});
  Pin ends;
  for (int j = 0; j <= grid.cells_z; ++j) {
    ends.particles.push_back(grid.index(0, j));
    ends.particles.push_back(grid.index(grid.cells_x, j));
  }
  world.set_pins(strip, {ends});
  // Tension of the springs between two columns of particles.
  const auto tension = [&](int column) {
    Vec3 sum = Vec3::Zero();
    const ClothModel& model = world.model(strip);
    for (std::size_t k = 0; k < topology->springs.size(); ++k) {
      const Spring& s = topology->springs[k];
      const int i = s.i % (grid.cells_x + 1), j = s.j % (grid.cells_x + 1);
      if (std::min(i, j) != column || std::max(i, j) != column + 1) continue;
      const Vec3 between = world.state(strip).position(s.j) - world.state(strip).position(s.i);
      sum +=
          (i < j ? 1.0 : -1.0) * spring_force(model.stiffness(static_cast<int>(k)), s.rest_length, between);
    }
    return sum.norm();
  };
  run(world, setup, 2.0, [] {});
  double slack = 0, tight = 0;
  run(world, setup, 1.0, [&] {
    tight += tension(1);
    slack += tension(grid.cells_x - 2);
  });
  return {tight / slack, std::exp(friction * kPi)};
}

RestingSheet rest_on(const ContactExperiment& setup, Support support, double seconds) {
  World world = make_world(setup);
  constexpr double kRadius = 0.3;
  double height = kSoft.thickness / 2 + 0.01;
  if (support == Support::ball) {
    world.add_collider({"ball", Sphere{Vec3::Zero(), kRadius}, 0.4, {}});
    height += kRadius;
  } else {
    world.add_collider({"floor", Plane{Vec3::Zero(), Vec3::UnitY()}, 0.4, {}});
  }
  const ClothId sheet = add_sheet(world, "sheet", setup.cells, 0.8, Mat3::Identity(), Vec3(0, height, 0));
  const double mass = mass_of(world, sheet);
  RestingSheet rest;
  double last = height;
  const auto watch_rise = [&] {
    const double now = middle_of(world, sheet).y();
    rest.rise = std::max(rest.rise, now - last);
    last = now;
  };
  run(world, setup, seconds / 2, watch_rise);
  const Vec3 before = middle_of(world, sheet);
  double impulse = 0;  // of all contacts, upwards [N·s]
  std::vector<double> kinetic;
  run(world, setup, seconds / 2, [&] {
    watch_rise();
    kinetic.push_back(compute_kinetic_energy(world.model(sheet), world.state(sheet)) / mass);
    rest.drift = std::max(rest.drift, (middle_of(world, sheet) - before).norm());
    for (const ContactPoint& p : world.contact_points()) impulse += p.force.y() / setup.steps_per_second;
  });
  std::sort(kinetic.begin(), kinetic.end());
  rest.kinetic = kinetic.back();
  rest.speed = std::sqrt(2 * kinetic[kinetic.size() / 2]);
  rest.force = impulse / (mass * kGravity * seconds / 2);
  return rest;
}

Spin spin_ball(const ContactExperiment& setup, double friction) {
  constexpr double kRadius = 0.3, kSize = 0.4, kTurns_deg = 180;
  // A second to come to rest, then key frames every twentieth of a second.
  std::vector<KeyFrame> keys;
  const auto angle_at = [](double t) { return 0.5 * kTurns_deg * t * t; };
  for (int k = 0; k <= 20; ++k)
    keys.push_back({.time = 1 + 0.05 * k, .angles_deg = {0, angle_at(0.05 * k), 0}});
  World world = make_world(setup);
  world.add_collider({"ball", Sphere{Vec3::Zero(), kRadius}, friction, RigidMotion(keys)});
  const ClothId sheet =
      add_sheet(world, "sheet", setup.cells, kSize, Mat3::Identity(), Vec3(0, kRadius + kSoft.thickness, 0));
  const auto heading = [&] {
    const Vec3 side = world.state(sheet).position(setup.cells) - world.state(sheet).position(0);
    return std::atan2(-side.z(), side.x());
  };
  run(world, setup, 1, [] {});
  Spin spin{.turned_ball = radians(angle_at(1))};
  double last = heading();
  spin.torque = watch_turning(world, setup, 1, sheet, friction, spin.friction, [&] {
    const double now = heading();
    spin.turned_sheet += std::remainder(now - last, 2 * kPi);
    last = now;
  });
  spin.expected = std::min(spin.turned_ball, 0.5 * friction * kGravity * square_lever(kSize));
  return spin;
}

Turntable turn_table(const ContactExperiment& setup, double friction, double floor_acceleration) {
  constexpr double kSize = 0.3, kSettle = 0.25, kSeconds = 0.3;
  World world = make_world(setup);
  const auto turned_by = [](double angle) { return KeyFrame{.angles_deg = {0, angle * 180 / kPi, 0}}; };
  world.add_collider({"table", Plane{Vec3::Zero(), Vec3::UnitY()}, friction,
                      accelerate(setup, kSettle, kSeconds, floor_acceleration, turned_by)});
  const ClothId sheet =
      add_sheet(world, "sheet", setup.cells, kSize, Mat3::Identity(), Vec3(0, kSoft.thickness / 2, 0));
  run(world, setup, kSettle, [] {});
  double lever = 0, inertia = 0;  // Σ m r, Σ m r²
  for (int i = 0; i < world.model(sheet).num_particles(); ++i) {
    const Vec3 p = world.state(sheet).position(i);
    const double m = world.model(sheet).mass[i], r = std::hypot(p.x(), p.z());
    lever += m * r;
    inertia += m * r * r;
  }
  Turntable result{.expected = std::min(floor_acceleration, friction * kGravity * lever / inertia)};
  result.torque = watch_turning(world, setup, kSeconds, sheet, friction, result.friction, [] {});
  result.acceleration = angular_momentum_of(world, sheet) / inertia / kSeconds;
  return result;
}

CarriedSheet carry_sheet(const ContactExperiment& setup, double friction, double lower_acceleration) {
  constexpr double kSize = 0.2, kLowerSize = 0.8, kSettle = 0.25, kSeconds = 0.3;
  World world = make_world(setup);
  const ClothId lower =
      add_sheet(world, "lower", 3 * setup.cells, kLowerSize, Mat3::Identity(), Vec3::Zero());
  const ClothId upper = add_sheet(world, "upper", setup.cells, kSize, rotation_from_angles_deg({0, 7, 0}),
                                  Vec3(0.2, kSoft.thickness, 0));
  world.set_friction("lower", "upper", friction);
  const auto moved_by = [](double way) { return KeyFrame{.translation = {way, 0, 0}}; };
  pin_all(world, lower, accelerate(setup, kSettle, kSeconds, lower_acceleration, moved_by));
  run(world, setup, kSettle, [] {});
  CarriedSheet result{.expected = std::min(lower_acceleration, friction * kGravity)};
  run(world, setup, kSeconds,
      [&] { result.friction += audit_friction(world, 1.0 / setup.steps_per_second, friction); });
  const Vec3 momentum = compute_momentum(world.model(upper), world.state(upper));
  result.acceleration = momentum.x() / mass_of(world, upper) / kSeconds;
  return result;
}

FoldedFall drop_fold(const ContactExperiment& setup, double seconds) {
  // Two halves 1.5 thicknesses apart, joined by half a circle.
  constexpr double kLength = 0.6, kWidth = 0.3;
  const double radius = 0.75 * kSoft.thickness, turn = kPi * radius, half = (kLength - turn) / 2;
  const Grid grid{.size_x = kLength, .size_z = kWidth, .cells_x = 2 * setup.cells, .cells_z = setup.cells};
  const auto topology = build_grid_topology(grid, SpringModel::alternating);
  std::vector<Vec3> positions;
  for (const Vec3& p : topology->mesh.positions) {
    const double arc = std::clamp((p.x() - half) / radius, 0.0, kPi),
                 rest = std::max(0.0, p.x() - half - turn);
    positions.push_back(
        {std::min(p.x(), half) + radius * std::sin(arc) - rest, radius * (1 - std::cos(arc)), p.z()});
  }
  World world = make_world(setup);
  const ClothId fold =
      world.add_cloth({.name = "fold", .topology = topology, .material = kSoft, .positions = positions});
  const double mass = mass_of(world, fold), gain = kGravity / setup.steps_per_second;
  FoldedFall fall{1};
  Vec3 last = Vec3::Zero();
  run(world, setup, seconds, [&] {
    const Vec3 now = compute_momentum(world.model(fold), world.state(fold)) / mass;
    const double share = (last - now).y() / gain;
    if (std::abs(share - 1) > std::abs(fall.worst_gain - 1)) fall.worst_gain = share;
    last = now;
  });
  return fall;
}

Collision collide_sheets(const ContactExperiment& setup, double seconds) {
  World world = make_world(setup);
  world.set_gravity(Vec3::Zero());
  constexpr double kSpeed = 1;
  const ClothId below = add_sheet(world, "below", setup.cells, 0.4, Mat3::Identity(), Vec3::Zero(), kSoft,
                                  Vec3(0.2, kSpeed, 0));
  const ClothId above = add_sheet(world, "above", setup.cells, 0.3, rotation_from_angles_deg({4, 25, 3}),
                                  Vec3(0.03, 0.05, 0.02), kSoft, Vec3(0, -kSpeed, 0));
  const auto momentum = [&] {
    return Vec3(compute_momentum(world.model(below), world.state(below)) +
                compute_momentum(world.model(above), world.state(above)));
  };
  const Vec3 before = momentum();
  const double scale = compute_momentum(world.model(below), world.state(below)).norm();
  Collision collision;
  run(world, setup, seconds, [&] {
    collision.momentum_change = std::max(collision.momentum_change, (momentum() - before).norm() / scale);
    collision.contacts = std::max(collision.contacts, static_cast<int>(world.contact_points().size()));
  });
  return collision;
}

}  // namespace weft::engine::lab
