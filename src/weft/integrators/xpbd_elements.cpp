#include "weft/integrators/xpbd_elements.h"

#include <algorithm>
#include <array>
#include <span>

#include "weft/forces/collapse.h"
#include "weft/forces/hinge.h"
#include "weft/forces/membrane_patch.h"
#include "weft/forces/pressure.h"
#include "weft/forces/seam_springs.h"

namespace weft::engine {
namespace {

constexpr int kGrain = 256;  // elements per chunk of work

struct Step {
  double h = 0;        // [s]
  double damping = 0;  // τ/h [1]
};

/// An element with one strain of gradient ∂e/∂x_c at each of its particles.
struct Scalar {
  double force = 0;      // ∂W/∂e
  double stiffness = 0;  // ∂²W/∂e²
};

/// λ of a strain whose gradients have Σ |g_c|²/m_c = `compliance` and have grown by `grown` in the substep.
double multiplier(const Step& step, const Scalar& response, double compliance, double grown) {
  const double h2 = step.h * step.h, k = h2 * response.stiffness;
  return (h2 * response.force + step.damping * k * grown) / (1 + (1 + step.damping) * k * compliance);
}

/// Projects three strains of a patch with their derivatives at its vertices.
void project_strains(const MembranePatch& patch, const std::array<Mat3, 4>& derivative, double area,
                     const MembraneResponse& response, const Step& step, XpbdParticles& particles) {
  Mat3 compliance = Mat3::Zero();
  Vec3 grown = Vec3::Zero();
  for (int v = 0; v < patch.num_vertices(); ++v) {
    const int i = patch.vertices[v];
    compliance += particles.particle[i].inv_mass() * derivative[v] * derivative[v].transpose();
    grown += derivative[v] * particles.moved(i);
  }
  const double h2_area = step.h * step.h * area;
  const Mat3 k = h2_area * response.tangent;
  const Mat3 system = Mat3::Identity() + (1 + step.damping) * k * compliance;
  const Vec3 lambda = system.inverse() * (h2_area * response.stress + step.damping * (k * grown));
  for (int v = 0; v < patch.num_vertices(); ++v) {
    const int i = patch.vertices[v];
    particles.move(i, -particles.particle[i].inv_mass() * (derivative[v].transpose() * lambda));
  }
}

void project_stencil(const BendingRows& rows, int row, const Step& step, XpbdParticles& particles) {
  Vec3 curvature = Vec3::Zero(), grown = Vec3::Zero();
  double compliance = 0;
  for (int k = rows.begin[row]; k < rows.begin[row + 1]; ++k) {
    const int i = rows.vertex[k];
    const double w = rows.weight[k];
    curvature += w * particles.position(i);
    grown += w * particles.moved(i);
    compliance += w * w * particles.particle[i].inv_mass();
  }
  const double length = curvature.norm();
  if (length == 0) return;
  const Vec3 direction = curvature / length;
  const Scalar response{rows.stiffness[row] * length, rows.stiffness[row]};
  const double lambda = multiplier(step, response, compliance, direction.dot(grown));
  for (int k = rows.begin[row]; k < rows.begin[row + 1]; ++k) {
    const int i = rows.vertex[k];
    particles.move(i, -particles.particle[i].inv_mass() * lambda * rows.weight[k] * direction);
  }
}

/// Projects an element with a given gradient for `N` particles.
template <std::size_t N>
void project_scalar(const std::array<int, N>& vertices, const std::array<Vec3, N>& gradient,
                    const Scalar& response, const Step& step, XpbdParticles& particles) {
  double compliance = 0, grown = 0;
  for (std::size_t c = 0; c < N; ++c) {
    compliance += particles.particle[vertices[c]].inv_mass() * gradient[c].squaredNorm();
    grown += gradient[c].dot(particles.moved(vertices[c]));
  }
  const double lambda = multiplier(step, response, compliance, grown);
  for (std::size_t c = 0; c < N; ++c)
    particles.move(vertices[c], -particles.particle[vertices[c]].inv_mass() * lambda * gradient[c]);
}

/// Positions of the patch's vertices.
PatchCorners corners_of(const MembranePatch& patch, const XpbdParticles& particles) {
  PatchCorners x;
  x.fill(Vec3::Zero());
  for (int v = 0; v < patch.num_vertices(); ++v) x[v] = particles.position(patch.vertices[v]);
  return x;
}

/// The mean strain; of a pair then the difference, and the triangles' limits.
void project_patch(const MembranePatch& patch, const PatchLaw& law, const Step& step,
                   XpbdParticles& particles) {
  const bool is_pair = patch.num_triangles == 2;
  PatchCorners x = corners_of(patch, particles);
  project_strains(patch, patch_strain_derivative(patch, x).mean, patch.area(),
                  membrane_response(is_pair ? law.mean : law.alone, patch_strain(patch, x).mean), step,
                  particles);
  if (!is_pair) return;
  x = corners_of(patch, particles);
  project_strains(patch, patch_strain_derivative(patch, x).difference, difference_area(patch),
                  difference_response(law.difference, patch_strain(patch, x).difference), step, particles);
  if (law.limit.limit.stiffness == 0) return;
  for (int t = 0; t < 2; ++t) {
    x = corners_of(patch, particles);
    const auto& [a, b, c] = patch.corners[t];
    const TriangleCorners own = {x[a], x[b], x[c]};
    const MembraneResponse response = membrane_response(law.limit, membrane_strain(patch.rest[t], own));
    if (response.stress.isZero(0)) continue;
    std::array<Mat3, 4> derivative;
    derivative.fill(Mat3::Zero());
    const std::array<Mat3, 3> of_triangle = membrane_strain_derivative(patch.rest[t], own);
    for (int k = 0; k < 3; ++k) derivative[patch.corners[t][k]] = of_triangle[k];
    project_strains(patch, derivative, patch.rest[t].area, response, {.h = step.h}, particles);
  }
}

void project_collapse(const MembranePatch& patch, const StrainLimit& law, double h,
                      XpbdParticles& particles) {
  for (int t = 0; t < patch.num_triangles; ++t) {
    const auto& [a, b, c] = patch.corners[t];
    const std::array<int, 3> vertices = {patch.vertices[a], patch.vertices[b], patch.vertices[c]};
    const TriangleCorners x = {particles.position(vertices[0]), particles.position(vertices[1]),
                               particles.position(vertices[2])};
    const double area = patch.rest[t].area;
    for (const auto& [response, gradient] : collapse_axes(patch.rest[t], law, x)) {
      if (response.tension == 0) continue;
      project_scalar(vertices, gradient, {area * response.tension, area * response.stiffness}, {.h = h},
                     particles);
    }
  }
}

void project_hinge(const HingeElement& hinge, const Step& step, XpbdParticles& particles) {
  HingeCorners x;
  for (int c = 0; c < 4; ++c) x[c] = particles.position(hinge.vertices[c]);
  const Scalar response{hinge.stiffness * hinge_angle(x), hinge.stiffness};
  project_scalar(hinge.vertices, hinge_angle_gradient(x), response, step, particles);
}

/// A spring's strain limit, with the spring's strain and energy per rest length.
void project_limit(const Spring& spring, const StrainLimit& limit, double h, XpbdParticles& particles) {
  const Vec3 d = particles.position(spring.j) - particles.position(spring.i);
  const double length = d.norm();
  const LimitResponse response = limit_response(limit, length / spring.rest_length - 1);
  if (response.tension == 0) return;
  const Vec3 along = d / length;
  project_scalar(std::array<int, 2>{spring.i, spring.j}, std::array<Vec3, 2>{-along, along},
                 {response.tension, response.stiffness / spring.rest_length}, {.h = h}, particles);
}

void project_seam(const SeamSpring& spring, double closed, double opening, double h,
                  XpbdParticles& particles) {
  const Vec3 gap = seam_gap(spring, [&](int particle) { return particles.position(particle); });
  const SeamPull pull = seam_pull(spring, closed, opening, gap);
  if (pull.along == 0) return;
  const auto weights = spring.weights();
  project_scalar(spring.particles,
                 std::array<Vec3, 3>{weights[0] * pull.direction, weights[1] * pull.direction,
                                     weights[2] * pull.direction},
                 {pull.force.norm(), pull.along}, {.h = h}, particles);
}

/// body(item) for all items, one colour after the other.
template <class Body>
void for_colours(const Colours& colours, JobSystem& jobs, const Body& body) {
  for (std::size_t colour = 0; colour + 1 < colours.begin.size(); ++colour) {
    const int first = colours.begin[colour];
    parallel_for(jobs, colours.begin[colour + 1] - first, kGrain, [&](int begin, int end) {
      for (int k = begin; k < end; ++k) body(colours.item[first + k]);
    });
  }
}

}  // namespace

XpbdElements::XpbdElements(const ClothModel& model) : topology_(model.topology), elements_(model.elements) {
  if (elements_) colour_elements(*elements_);
  const std::vector<SeamSpring>& seams = topology_->seams.springs;
  seams_ = colour_items(static_cast<int>(seams.size()), model.num_particles(),
                        [&](int k) -> const std::array<int, 3>& { return seams[k].particles; });
}

void XpbdElements::colour_elements(const ClothElements& e) {
  const int num_particles = topology_->num_particles();
  patches_ = colour_items(static_cast<int>(e.patches.size()), num_particles, [&](int k) {
    return std::span(e.patches[k].vertices).first(static_cast<std::size_t>(e.patches[k].num_vertices()));
  });
  stencils_ = colour_items(e.bending.num_rows(), num_particles, [&](int r) {
    return std::span(e.bending.vertex)
        .subspan(e.bending.begin[r], e.bending.begin[r + 1] - e.bending.begin[r]);
  });
  hinges_ = colour_items(static_cast<int>(e.hinges.size()), num_particles,
                         [&](int k) -> const std::array<int, 4>& { return e.hinges[k].vertices; });
  if (e.spring_limit.stiffness == 0) return;
  const std::vector<Spring>& springs = topology_->springs;
  for (std::size_t s = 0; s < springs.size(); ++s) {
    if (springs[s].kind != SpringKind::bend) limited_.push_back(static_cast<int>(s));
  }
  limits_ = colour_items(static_cast<int>(limited_.size()), num_particles, [&](int k) {
    return std::array<int, 2>{springs[limited_[k]].i, springs[limited_[k]].j};
  });
}

void XpbdElements::set_numbers(const ClothModel& model) {
  collapse_law_ = make_collapse_law(model);
  closed_seam_ = closed_seam(model);
}

void XpbdElements::project(const XpbdSubstep& substep, JobSystem& jobs, XpbdParticles& particles) {
  const double h = substep.step;
  if (elements_) project_elements(*elements_, h, jobs, particles);
  for_colours(seams_, jobs, [&](int k) {
    project_seam(topology_->seams.springs[k], closed_seam_, substep.seam_opening, h, particles);
  });
  if (substep.gas.is_active()) project_gas(substep.gas, h, particles);
}

void XpbdElements::project_elements(const ClothElements& e, double step, JobSystem& jobs,
                                    XpbdParticles& particles) const {
  const Step damped{step, e.damping / step};
  const PatchLaw law = e.law();
  for_colours(stencils_, jobs, [&](int r) { project_stencil(e.bending, r, damped, particles); });
  for_colours(hinges_, jobs, [&](int k) { project_hinge(e.hinges[k], damped, particles); });
  for_colours(patches_, jobs, [&](int k) {
    project_patch(e.patches[k], law, damped, particles);
    project_collapse(e.patches[k], collapse_law_, step, particles);
  });
  for_colours(limits_, jobs, [&](int k) {
    project_limit(topology_->springs[limited_[k]], e.spring_limit, step, particles);
  });
}

void XpbdElements::project_gas(const Gas& gas, double step, XpbdParticles& particles) {
  const std::span<const Triangle> triangles = topology_->mesh.triangles;
  const auto at = [&](int v) { return particles.position(v); };
  gradient_.assign(particles.size(), Vec3::Zero());
  add_volume_gradient(triangles, at,
                      [&](int v, const Vec3& part) { gradient_[v] += gas.orientation * part; });
  double compliance = 0;
  for (int i = 0; i < particles.size(); ++i)
    compliance += particles.particle[i].inv_mass() * gradient_[i].squaredNorm();
  // Sealed gas that is squeezed flat or turned inside out pushes as at a thousandth of its volume.
  const double volume =
      std::max(gas.orientation * compute_signed_volume(triangles, at), 1e-3 * gas.sealed_volume);
  const Scalar response{-gas_excess(gas, volume), gas_stiffness(gas, volume)};
  const double lambda = multiplier({.h = step}, response, compliance, 0);
  for (int i = 0; i < particles.size(); ++i)
    particles.move(i, -particles.particle[i].inv_mass() * lambda * gradient_[i]);
}

}  // namespace weft::engine
