#include "weft/contact/response.h"

#include <algorithm>

#include "weft/core/simd.h"

namespace weft {
namespace {

constexpr int kGrain = 4096;  // particles per chunk

/// What the test in floats adds to a collider's size, so that rounding hides no particle from the exact test
/// [m].
constexpr double kFloatMargin = 1e-4;

/// Where two colliders meet, leaving one may enter the other: go round this often at most.
constexpr int kMaxRounds = 4;

/// How much stiffer than its inertia, m/h², a particle's contact is: the higher, the less a particle is
/// pressed in during the solve, and the less is left for hold_off_colliders to mend. At rest under gravity g
/// h²/1000, 3 µm at 60 steps per second.
constexpr double kContactStiffness = 1000;

/// The tangential velocity left by friction with the normal velocity change `push` [m/s].
Vec3 slow_down(const Vec3& tangential, double friction, double push) {
  const double speed = tangential.norm();
  return speed > 0 ? Vec3(std::max(0.0, 1 - friction * push / speed) * tangential) : tangential;
}

/// True if the particle was too near and has been moved.
bool push_out(const MovingCollider& moving, const ContactStep& step, Vec3& position, Vec3& velocity) {
  const SignedDistance surface = signed_distance(moving.shape, position);
  if (surface.distance >= step.gap) return false;

  const Vec3 surface_velocity = moving.velocity_at(position, step.step);
  const Vec3 relative = velocity - surface_velocity;
  const double approach = std::max(0.0, -relative.dot(surface.normal));
  const Vec3 tangential = relative - relative.dot(surface.normal) * surface.normal;
  const Vec3 slowed = slow_down(tangential, moving.collider->friction, approach);
  velocity += approach * surface.normal + (slowed - tangential);

  // Friction also takes back the slide of this step, so that what sticks does not creep.
  position += step.step * (slowed - tangential);
  const SignedDistance now = signed_distance(moving.shape, position);
  if (now.distance < step.gap) position += (step.gap - now.distance) * now.normal;
  return true;
}

/// Marks the particles that may be within `reach` of the shape.
void mark_near(const Sphere& sphere, double reach, const ClothState& state, int begin, int end,
               char* is_near) {
  const Eigen::Vector3f center = (sphere.center - state.origin).cast<float>();
  const float radius = static_cast<float>(sphere.radius + reach);
  const float *x = state.x.x(), *y = state.x.y(), *z = state.x.z();
  WEFT_IVDEP
  for (int i = begin; i < end; ++i) {
    const float dx = x[i] - center.x(), dy = y[i] - center.y(), dz = z[i] - center.z();
    is_near[i] = static_cast<char>(is_near[i] | (dx * dx + dy * dy + dz * dz < radius * radius));
  }
}

void mark_near(const Plane& plane, double reach, const ClothState& state, int begin, int end, char* is_near) {
  const Eigen::Vector3f normal = plane.normal.cast<float>();
  const float height = static_cast<float>(plane.normal.dot(plane.point - state.origin) + reach);
  const float *x = state.x.x(), *y = state.x.y(), *z = state.x.z();
  WEFT_IVDEP
  for (int i = begin; i < end; ++i) {
    const float along = normal.x() * x[i] + normal.y() * y[i] + normal.z() * z[i];
    is_near[i] = static_cast<char>(is_near[i] | (along < height));
  }
}

/// Of other shapes every particle counts as near.
template <class Shape>
void mark_near(const Shape&, double, const ClothState&, int begin, int end, char* is_near) {
  std::fill(is_near + begin, is_near + end, char{1});
}

}  // namespace

Vec3 MovingCollider::velocity_at(const Vec3& p, double step) const {
  if (collider->motion.is_still()) return Vec3::Zero();
  return (p - apply(before, pivot, apply_inverse(after, pivot, p))) / step;
}

void ContactResponse::begin_step(const std::vector<Collider>& colliders, const ContactStep& step) {
  step_ = step;
  moving_.clear();
  for (const Collider& c : colliders) {
    moving_.push_back({&c, shape_at(c, step.time), weft::pivot(c.shape), c.motion.at(step.time - step.step),
                       c.motion.at(step.time)});
  }
}

void ContactResponse::find_contacts(const Vec3& acceleration, const std::vector<double>& mass,
                                    const std::vector<char>& is_pinned, const ClothState& state,
                                    std::vector<Contact>& contacts) const {
  contacts.clear();
  const double h = step_.step;
  for (const MovingCollider& moving : moving_) {
    for (int i = 0; i < static_cast<int>(state.x.size()); ++i) {
      if (is_pinned[i]) continue;
      const Vec3 here = state.position(i), flight = h * state.v.get(i) + h * h * acceleration;
      const SignedDistance now = signed_distance(moving.shape, here);
      if (now.distance > step_.gap + 2 * flight.norm()) continue;
      // The plane belongs to where the particle would arrive, unless that lies beyond the collider's middle.
      SignedDistance then = signed_distance(moving.shape, here + flight);
      Vec3 foot = state.x.get(i) + flight - then.distance * then.normal;
      if (then.normal.dot(now.normal) <= 0) {
        then = now;
        foot = state.x.get(i) - now.distance * now.normal;
      }
      contacts.push_back({.particle = i,
                          .normal = then.normal,
                          .offset = then.normal.dot(foot) + step_.gap,
                          .stiffness = kContactStiffness * mass[i] / (h * h),
                          .friction = moving.collider->friction,
                          .grip = state.x.get(i) + h * moving.velocity_at(here, h)});
    }
  }
}

void ContactResponse::hold_off(const std::vector<char>& is_pinned, JobSystem& jobs, ClothState& state) {
  is_near_.assign(state.x.size(), 0);
  parallel_for(jobs, static_cast<int>(state.x.size()), kGrain, [&](int begin, int end) {
    for (const MovingCollider& moving : moving_) {
      const double reach = step_.gap + kFloatMargin;
      std::visit([&](const auto& s) { mark_near(s, reach, state, begin, end, is_near_.data()); },
                 moving.shape);
    }
    for (int i = begin; i < end; ++i) {
      if (!is_near_[i] || is_pinned[i]) continue;
      Vec3 position = state.position(i), velocity = state.v.get(i);
      bool touched = false;
      for (int round = 0; round < kMaxRounds; ++round) {
        bool moved = false;
        for (const MovingCollider& moving : moving_) moved |= push_out(moving, step_, position, velocity);
        if (!moved) break;
        touched = true;
      }
      if (!touched) continue;
      state.set_position(i, position);
      state.v.set(i, velocity);
    }
  });
}

}  // namespace weft
