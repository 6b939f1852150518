#include "weft/integrators/element_terms.h"

#include <algorithm>

#include "weft/forces/bending.h"

namespace weft::engine {
namespace {

HingeCorners corners_of(const HingeElement& h, const std::vector<Vec3>& x) {
  return {x[h.vertices[0]], x[h.vertices[1]], x[h.vertices[2]], x[h.vertices[3]]};
}

}  // namespace

void ElementTerms::begin_step(const ClothElements& elements, double step, const std::vector<Vec3>& start,
                              const std::vector<Vec3>& shape) {
  elements_ = &elements;
  start_ = start;
  damped_.clear();
  vertex_.clear();
  weight_.clear();
  if (elements.damping == 0) return;
  damp_membranes(elements.damping / step, shape);
  damp_bending(elements.damping / step, shape);
}

/// δeᵀ C δe of the mean strain as three rows, by the Cholesky factorisation C = Σ d l lᵀ, and three rows of the
/// difference.
void ElementTerms::damp_membranes(double share, const std::vector<Vec3>& shape) {
  for (const MembranePatch& patch : elements_->patches) {
    const PatchDerivative derivative = patch_strain_derivative(patch, corners_of(patch, shape));
    const auto add_row = [&](const std::array<Mat3, 4>& of_strain, const Vec3& l, double stiffness) {
      const int begin = static_cast<int>(vertex_.size());
      for (int v = 0; v < patch.num_vertices(); ++v) {
        vertex_.push_back(patch.vertices[v]);
        weight_.push_back(of_strain[v].transpose() * l);
      }
      damped_.push_back({begin, static_cast<int>(vertex_.size()), stiffness});
    };
    Mat3 rest = elements_->stiffness;
    for (int c = 0; c < 3; ++c) {
      const double pivot = rest(c, c);
      const Vec3 l = rest.col(c) / pivot;
      rest -= pivot * l * l.transpose();
      add_row(derivative.mean, l, share * patch.area() * pivot);
    }
    if (patch.num_triangles == 1) continue;
    const double stiffness = share * difference_area(patch) * elements_->difference.stiffness;
    for (int c = 0; c < 3; ++c) add_row(derivative.difference, Vec3::Unit(c), stiffness);
  }
}

void ElementTerms::damp_bending(double share, const std::vector<Vec3>& shape) {
  const BendingRows& rows = elements_->bending;
  for (int r = 0; r < rows.num_rows(); ++r) {
    const Vec3 curvature = bending_curvature(rows, r, shape);
    if (curvature.norm() == 0) continue;
    const Vec3 direction = curvature.normalized();
    const int begin = static_cast<int>(vertex_.size());
    for (int k = rows.begin[r]; k < rows.begin[r + 1]; ++k) {
      vertex_.push_back(rows.vertex[k]);
      weight_.push_back(rows.weight[k] * direction);
    }
    damped_.push_back({begin, static_cast<int>(vertex_.size()), share * rows.stiffness[r]});
  }
  for (const HingeElement& h : elements_->hinges) {
    const HingeCorners gradient = hinge_angle_gradient(corners_of(h, shape));
    const int begin = static_cast<int>(vertex_.size());
    vertex_.insert(vertex_.end(), h.vertices.begin(), h.vertices.end());
    weight_.insert(weight_.end(), gradient.begin(), gradient.end());
    damped_.push_back({begin, begin + 4, share * h.stiffness});
  }
}

double ElementTerms::energy(const std::vector<Vec3>& x) const {
  const PatchLaw law = elements_->law();
  double energy = bending_energy(elements_->bending, x);
  for (const MembranePatch& patch : elements_->patches)
    energy += patch_energy(patch, law, corners_of(patch, x));
  for (const HingeElement& h : elements_->hinges) energy += hinge_energy(h.stiffness, 0, corners_of(h, x));
  for (const DampedRow& row : damped_) {
    double change = 0;
    for (int k = row.begin; k < row.end; ++k) change += weight_[k].dot(x[vertex_[k]] - start_[vertex_[k]]);
    energy += 0.5 * row.stiffness * change * change;
  }
  return energy;
}

bool ElementTerms::is_beyond_limit(const std::vector<Vec3>& x) const {
  if (elements_->limit.stiffness == 0) return false;
  const auto is_beyond = [&](const MembraneElement& m) {
    const auto& [a, b, c] = m.vertices;
    return principal_stretches(m.rest, {x[a], x[b], x[c]})[1] > 1 + elements_->limit.allowed();
  };
  return std::any_of(elements_->membranes.begin(), elements_->membranes.end(), is_beyond);
}

void ElementTerms::add_gradient(const std::vector<Vec3>& x, std::vector<Vec3>& gradient) const {
  const PatchLaw law = elements_->law();
  for (const MembranePatch& patch : elements_->patches) {
    const PatchCorners force = patch_force(patch, law, corners_of(patch, x));
    for (int v = 0; v < patch.num_vertices(); ++v) gradient[patch.vertices[v]] -= force[v];
  }
  for (const HingeElement& h : elements_->hinges) {
    const HingeCorners force = hinge_force(h.stiffness, 0, corners_of(h, x));
    for (int c = 0; c < 4; ++c) gradient[h.vertices[c]] -= force[c];
  }
  const BendingRows& rows = elements_->bending;
  for (int r = 0; r < rows.num_rows(); ++r) {
    const Vec3 moment = rows.stiffness[r] * bending_curvature(rows, r, x);
    for (int k = rows.begin[r]; k < rows.begin[r + 1]; ++k)
      gradient[rows.vertex[k]] += rows.weight[k] * moment;
  }
  for (const DampedRow& row : damped_) {
    double change = 0;
    for (int k = row.begin; k < row.end; ++k) change += weight_[k].dot(x[vertex_[k]] - start_[vertex_[k]]);
    for (int k = row.begin; k < row.end; ++k) gradient[vertex_[k]] += row.stiffness * change * weight_[k];
  }
}

void ElementTerms::add_hessian(const std::vector<Vec3>& x, StressFilter filter, const AddBlock& add) const {
  const PatchLaw law = elements_->law();
  for (const MembranePatch& patch : elements_->patches) {
    const PatchHessian hessian = patch_hessian(patch, law, corners_of(patch, x));
    for (int a = 0; a < patch.num_vertices(); ++a) {
      for (int b = 0; b <= a; ++b)
        add(patch.vertices[a], patch.vertices[b], patch_block(patch, hessian, a, b, filter));
    }
  }
  for (const HingeElement& h : elements_->hinges) {
    const HingeCorners gradient = hinge_angle_gradient(corners_of(h, x));
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b <= a; ++b)
        add(h.vertices[a], h.vertices[b], hinge_gauss_newton_block(h.stiffness, gradient, a, b));
    }
  }
  const BendingRows& rows = elements_->bending;
  for (int r = 0; r < rows.num_rows(); ++r) {
    for (int a = rows.begin[r]; a < rows.begin[r + 1]; ++a) {
      for (int b = rows.begin[r]; b <= a; ++b) {
        const double value = rows.stiffness[r] * rows.weight[a] * rows.weight[b];
        add(rows.vertex[a], rows.vertex[b], value * Mat3::Identity());
      }
    }
  }
  for (const DampedRow& row : damped_) {
    for (int a = row.begin; a < row.end; ++a) {
      for (int b = row.begin; b <= a; ++b)
        add(vertex_[a], vertex_[b], row.stiffness * weight_[a] * weight_[b].transpose());
    }
  }
}

std::vector<std::pair<int, int>> ElementTerms::find_pairs(const ClothElements& elements) {
  std::vector<std::pair<int, int>> pairs;
  const auto add_all = [&](const int* vertices, int count) {
    for (int a = 0; a < count; ++a) {
      for (int b = 0; b < a; ++b) pairs.push_back(std::minmax(vertices[a], vertices[b]));
    }
  };
  for (const MembranePatch& patch : elements.patches) add_all(patch.vertices.data(), patch.num_vertices());
  for (const HingeElement& h : elements.hinges) add_all(h.vertices.data(), 4);
  const auto add_rows = [&](const auto& rows) {
    for (int r = 0; r < rows.num_rows(); ++r)
      add_all(rows.vertex.data() + rows.begin[r], rows.begin[r + 1] - rows.begin[r]);
  };
  add_rows(elements.bending);
  add_rows(elements.thread_bends);
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

}  // namespace weft::engine
