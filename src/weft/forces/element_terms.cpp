#include "weft/forces/element_terms.h"

#include <algorithm>

#include "weft/forces/bending.h"
#include "weft/forces/hinge.h"
#include "weft/forces/membrane_patch.h"

namespace weft::engine {
namespace {

HingeCorners corners_of(const HingeElement& h, const std::vector<Vec3>& x) {
  return {x[h.vertices[0]], x[h.vertices[1]], x[h.vertices[2]], x[h.vertices[3]]};
}

class MembraneTerm final : public Term {
 public:
  explicit MembraneTerm(const ClothElements& elements) : elements_(elements), law_(elements.law()) {}

  double energy(const Positions& x) const override {
    double energy = 0;
    for (const MembranePatch& patch : elements_.patches)
      energy += patch_energy(patch, law_, corners_of(patch, x));
    return energy;
  }

  void add_force(const Positions& x, std::vector<Vec3>& force) const override {
    for (const MembranePatch& patch : elements_.patches) {
      const PatchCorners own = patch_force(patch, law_, corners_of(patch, x));
      for (int v = 0; v < patch.num_vertices(); ++v) force[patch.vertices[v]] += own[v];
    }
  }

  void add_hessian(const Positions& x, HessianKind kind, const AddBlock& add) const override {
    const StressFilter filter = kind == HessianKind::exact ? StressFilter::exact : StressFilter::absolute;
    for (const MembranePatch& patch : elements_.patches) {
      const PatchHessian hessian = patch_hessian(patch, law_, corners_of(patch, x));
      add_all_blocks(
          patch.vertices.data(), patch.num_vertices(),
          [&](int a, int b) { return patch_block(patch, hessian, a, b, filter); }, add);
    }
  }

  void list_pairs(const AddPair& add) const override {
    for (const MembranePatch& patch : elements_.patches)
      list_all_pairs(patch.vertices.data(), patch.num_vertices(), add);
  }

  bool is_beyond_limit(const Positions& x) const override {
    if (elements_.limit.stiffness == 0) return false;
    return std::any_of(elements_.membranes.begin(), elements_.membranes.end(), [&](const MembraneElement& m) {
      const auto& [a, b, c] = m.vertices;
      return principal_stretches(m.rest, {x[a], x[b], x[c]})[1] > 1 + elements_.limit.allowed();
    });
  }

 private:
  const ClothElements& elements_;
  PatchLaw law_;
};

class StencilTerm final : public Term {
 public:
  explicit StencilTerm(const BendingRows& rows) : rows_(rows) {}

  double energy(const Positions& x) const override { return bending_energy(rows_, x); }

  void add_force(const Positions& x, std::vector<Vec3>& force) const override {
    add_bending_force(rows_, x, force);
  }

  void add_hessian(const Positions&, HessianKind, const AddBlock& add) const override {
    for (int r = 0; r < rows_.num_rows(); ++r) {
      const double* weight = &rows_.weight[rows_.begin[r]];
      add_all_blocks(
          &rows_.vertex[rows_.begin[r]], rows_.begin[r + 1] - rows_.begin[r],
          [&](int a, int b) { return Mat3(rows_.stiffness[r] * weight[a] * weight[b] * Mat3::Identity()); },
          add);
    }
  }

  void list_pairs(const AddPair& add) const override {
    for (int r = 0; r < rows_.num_rows(); ++r)
      list_all_pairs(rows_.vertex.data() + rows_.begin[r], rows_.begin[r + 1] - rows_.begin[r], add);
  }

 private:
  const BendingRows& rows_;
};

class HingeTerm final : public Term {
 public:
  explicit HingeTerm(const std::vector<HingeElement>& hinges) : hinges_(hinges) {}

  double energy(const Positions& x) const override {
    double energy = 0;
    for (const HingeElement& h : hinges_) energy += hinge_energy(h.stiffness, 0, corners_of(h, x));
    return energy;
  }

  void add_force(const Positions& x, std::vector<Vec3>& force) const override {
    for (const HingeElement& h : hinges_) {
      const HingeCorners own = hinge_force(h.stiffness, 0, corners_of(h, x));
      for (int c = 0; c < 4; ++c) force[h.vertices[c]] += own[c];
    }
  }

  void add_hessian(const Positions& x, HessianKind, const AddBlock& add) const override {
    for (const HingeElement& h : hinges_) {
      const HingeCorners gradient = hinge_angle_gradient(corners_of(h, x));
      add_all_blocks(
          h.vertices.data(), 4,
          [&](int a, int b) { return hinge_gauss_newton_block(h.stiffness, gradient, a, b); }, add);
    }
  }

  bool has_exact_hessian() const override { return false; }

  void list_pairs(const AddPair& add) const override {
    for (const HingeElement& h : hinges_) list_all_pairs(h.vertices.data(), 4, add);
  }

 private:
  const std::vector<HingeElement>& hinges_;
};

class ElementDampingTerm final : public Term {
 public:
  ElementDampingTerm(const ClothElements& elements, const Motion& motion) : start_(motion.start) {
    const double share = elements.damping / motion.step;
    damp_membranes(elements, share, motion.shape);
    damp_bending(elements, share, motion.shape);
  }

  double energy(const Positions& x) const override {
    double energy = 0;
    for (const Row& row : rows_) {
      const double own = change(row, x);
      energy += 0.5 * row.stiffness * own * own;
    }
    return energy;
  }

  void add_force(const Positions& x, std::vector<Vec3>& force) const override {
    for (const Row& row : rows_) {
      const double pull = row.stiffness * change(row, x);
      for (int k = row.begin; k < row.end; ++k) force[vertex_[k]] -= pull * weight_[k];
    }
  }

  void add_hessian(const Positions&, HessianKind, const AddBlock& add) const override {
    for (const Row& row : rows_) {
      const Vec3* weight = &weight_[row.begin];
      add_all_blocks(
          &vertex_[row.begin], row.end - row.begin,
          [&](int a, int b) { return Mat3(row.stiffness * weight[a] * weight[b].transpose()); }, add);
    }
  }

  void list_pairs(const AddPair& add) const override {
    for (const Row& row : rows_) list_all_pairs(vertex_.data() + row.begin, row.end - row.begin, add);
  }

 private:
  /// Vertices with weights: ½ stiffness (Σ weight·(x − x₀))².
  struct Row {
    int begin = 0, end = 0;  // range of vertex_ and weight_
    double stiffness = 0;
  };

  double change(const Row& row, const Positions& x) const {
    double change = 0;
    for (int k = row.begin; k < row.end; ++k) change += weight_[k].dot(x[vertex_[k]] - start_[vertex_[k]]);
    return change;
  }

  void end_row(int begin, double stiffness) {
    rows_.push_back({begin, static_cast<int>(vertex_.size()), stiffness});
  }

  /// δeᵀ C δe of the mean strain as three rows, by the Cholesky factorisation C = Σ d l lᵀ, and three rows of the
  /// difference.
  void damp_membranes(const ClothElements& elements, double share, const Positions& shape) {
    for (const MembranePatch& patch : elements.patches) {
      const PatchDerivative derivative = patch_strain_derivative(patch, corners_of(patch, shape));
      const auto add_row = [&](const std::array<Mat3, 4>& of_strain, const Vec3& l, double stiffness) {
        const int begin = static_cast<int>(vertex_.size());
        for (int v = 0; v < patch.num_vertices(); ++v) {
          vertex_.push_back(patch.vertices[v]);
          weight_.push_back(of_strain[v].transpose() * l);
        }
        end_row(begin, stiffness);
      };
      Mat3 rest = elements.stiffness;
      for (int c = 0; c < 3; ++c) {
        const double pivot = rest(c, c);
        const Vec3 l = rest.col(c) / pivot;
        rest -= pivot * l * l.transpose();
        add_row(derivative.mean, l, share * patch.area() * pivot);
      }
      if (patch.num_triangles == 1) continue;
      const double stiffness = share * difference_area(patch) * elements.difference.stiffness;
      for (int c = 0; c < 3; ++c) add_row(derivative.difference, Vec3::Unit(c), stiffness);
    }
  }

  void damp_bending(const ClothElements& elements, double share, const Positions& shape) {
    const BendingRows& rows = elements.bending;
    for (int r = 0; r < rows.num_rows(); ++r) {
      const Vec3 curvature = bending_curvature(rows, r, shape);
      if (curvature.norm() == 0) continue;
      const Vec3 direction = curvature.normalized();
      const int begin = static_cast<int>(vertex_.size());
      for (int k = rows.begin[r]; k < rows.begin[r + 1]; ++k) {
        vertex_.push_back(rows.vertex[k]);
        weight_.push_back(rows.weight[k] * direction);
      }
      end_row(begin, share * rows.stiffness[r]);
    }
    for (const HingeElement& h : elements.hinges) {
      const HingeCorners gradient = hinge_angle_gradient(corners_of(h, shape));
      const int begin = static_cast<int>(vertex_.size());
      vertex_.insert(vertex_.end(), h.vertices.begin(), h.vertices.end());
      weight_.insert(weight_.end(), gradient.begin(), gradient.end());
      end_row(begin, share * h.stiffness);
    }
  }

  const Positions& start_;
  std::vector<Row> rows_;
  std::vector<int> vertex_;
  std::vector<Vec3> weight_;  // weight times direction
};

}  // namespace

std::unique_ptr<Term> make_membrane_term(const ClothModel& model, const ClothState&) {
  if (!model.elements || model.elements->patches.empty()) return nullptr;
  return std::make_unique<MembraneTerm>(*model.elements);
}

std::unique_ptr<Term> make_stencil_term(const ClothModel& model, const ClothState&) {
  if (!model.elements || model.elements->bending.num_rows() == 0) return nullptr;
  return std::make_unique<StencilTerm>(model.elements->bending);
}

std::unique_ptr<Term> make_hinge_term(const ClothModel& model, const ClothState&) {
  if (!model.elements || model.elements->hinges.empty()) return nullptr;
  return std::make_unique<HingeTerm>(model.elements->hinges);
}

std::unique_ptr<Term> make_element_damping_term(const ClothModel& model, const Motion& motion) {
  if (!model.elements || model.elements->damping == 0) return nullptr;
  return std::make_unique<ElementDampingTerm>(*model.elements, motion);
}

}  // namespace weft::engine
