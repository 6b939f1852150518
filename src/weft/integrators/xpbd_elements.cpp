#include "weft/integrators/xpbd_elements.h"

#include <array>
#include <span>

#include "weft/forces/hinge.h"
#include "weft/forces/membrane_patch.h"

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

/// The mean strain; of a pair then the difference, and the triangles' limits.
void project_patch(const MembranePatch& patch, const PatchLaw& law, const Step& step,
                   XpbdParticles& particles) {
  const auto read = [&] {
    PatchCorners x;
    x.fill(Vec3::Zero());
    for (int v = 0; v < patch.num_vertices(); ++v) x[v] = particles.position(patch.vertices[v]);
    return x;
  };
  const bool is_pair = patch.num_triangles == 2;
  PatchCorners x = read();
  project_strains(patch, patch_strain_derivative(patch, x).mean, patch.area(),
                  membrane_response(is_pair ? law.mean : law.alone, patch_strain(patch, x).mean), step,
                  particles);
  if (!is_pair) return;
  x = read();
  project_strains(patch, patch_strain_derivative(patch, x).difference, difference_area(patch),
                  difference_response(law.difference, patch_strain(patch, x).difference), step, particles);
  if (law.limit.limit.stiffness == 0) return;
  for (int t = 0; t < 2; ++t) {
    x = read();
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

XpbdElements::XpbdElements(const ClothModel& model)
    : topology_(model.topology), elements_(model.elements), law_(elements_->law()) {
  const int num_particles = model.num_particles();
  const ClothElements& e = *elements_;
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

void XpbdElements::project(double step, JobSystem& jobs, XpbdParticles& particles) const {
  const ClothElements& e = *elements_;
  const Step damped{step, e.damping / step};
  for_colours(stencils_, jobs, [&](int r) { project_stencil(e.bending, r, damped, particles); });
  for_colours(hinges_, jobs, [&](int k) { project_hinge(e.hinges[k], damped, particles); });
  for_colours(patches_, jobs, [&](int k) { project_patch(e.patches[k], law_, damped, particles); });
  for_colours(limits_, jobs, [&](int k) {
    project_limit(topology_->springs[limited_[k]], e.spring_limit, step, particles);
  });
}

}  // namespace weft::engine
