#include "weft/integrators/scalar_preconditioner.h"

#include <algorithm>

namespace weft::engine {

namespace {

/// For each particle the coupled particles, and their coupling [N/m].
using Lists = std::vector<std::vector<std::pair<int, double>>>;

Lists springs_of_mesh(const ClothModel& model, double step) {
  constexpr int kLanes = NeighbourTable::kLanes;
  const NeighbourTable& table = model.topology->table;
  Lists lists(model.num_particles());
  for (int i = 0; i < model.num_particles(); ++i) {
    const int slice = i / kLanes;
    for (int row = table.slice_begin[slice]; row < table.slice_begin[slice + 1]; ++row) {
      const int entry = row * kLanes + i % kLanes, spring = table.spring[entry];
      if (spring < 0 || model.topology->springs[spring].kind == SpringKind::bend) continue;
      lists[i].emplace_back(table.neighbour[entry], model.stiffness(spring) + model.damping(spring) / step);
    }
  }
  return lists;
}

bool has_membranes(const ClothModel& model) { return model.elements && !model.elements->membranes.empty(); }

/// Factor of damping on the stiffness of elements.
double stiffening(const ClothElements& elements, double step) { return 1 + elements.damping / step; }

/// Stiffness of the elements' couplings, damping included [N/m].
std::vector<double> coupling_stiffness(const ClothElements& elements, double step,
                                       const std::vector<double>& added) {
  std::vector<double> stiffness;
  for (std::size_t k = 0; k < elements.couplings.size(); ++k)
    stiffness.push_back(stiffening(elements, step) * elements.couplings[k].stiffness +
                        (added.empty() ? 0.0 : added[k]));
  return stiffness;
}

Lists elements_of_mesh(const ClothModel& model, const std::vector<double>& stiffness) {
  Lists lists(model.num_particles());
  for (std::size_t k = 0; k < stiffness.size(); ++k) {
    const Coupling& c = model.elements->couplings[k];
    lists[c.i].emplace_back(c.j, stiffness[k]);
    lists[c.j].emplace_back(c.i, stiffness[k]);
  }
  return lists;
}

/// A seam couples its particle to the ends of its edge.
void add_seams(const ClothModel& model, Lists& lists) {
  for (const SeamSpring& s : model.topology->seams.springs) {
    const auto weights = s.weights();
    for (const int end : {1, 2}) {
      const double coupling = -s.stiffness * weights[end];
      if (coupling <= 0) continue;
      lists[s.particles[0]].emplace_back(s.particles[end], coupling);
      lists[s.particles[end]].emplace_back(s.particles[0], coupling);
    }
  }
}

}  // namespace

void ScalarPreconditioner::set_springs(const ClothModel& model, const PaddedRows& rows, double step,
                                       const std::vector<float>& least, const std::vector<int>& pinned,
                                       const std::vector<double>& added) {
  is_grid_ = model.topology->grid.has_value();
  first_ = rows.row(0);
  pinned_ = pinned;
  if (!is_grid_) {
    least_.assign(least.begin() + first_, least.begin() + first_ + model.num_particles());
    return build_mesh(model, step, added);
  }
  grid_.resize(rows);
  if (has_membranes(model)) {
    fill_grid_by_elements(*model.elements, step, added);
  } else {
    fill_grid_by_springs(model, step);
    if (!model.has_equal_springs() || !added.empty()) scale_grid_springs(model, step, added);
  }
  pin_grid();
}

void ScalarPreconditioner::set_diagonal(const std::vector<float>& diagonal, JobSystem& jobs) {
  if (!is_grid_) {
    more_.resize(least_.size());
    for (std::size_t i = 0; i < more_.size(); ++i)
      more_[i] = std::max(0.0f, diagonal[first_ + i] - least_[i]);
    for (const int p : pinned_) more_[p] = 0;
    return mesh_.add_excess(more_);
  }
  GridLevel& level = grid_.finest();
  std::copy(diagonal.begin(), diagonal.end(), level.excess.begin());
  for (const auto& [at, coupling] : ties_) level.excess[at] += coupling;
  for (const int p : pinned_) level.excess[level.rows.index(p)] = 0;
  grid_.build(jobs);
}

void ScalarPreconditioner::build_mesh(const ClothModel& model, double step,
                                      const std::vector<double>& added) {
  Lists lists = has_membranes(model)
                    ? elements_of_mesh(model, coupling_stiffness(*model.elements, step, added))
                    : springs_of_mesh(model, step);
  add_seams(model, lists);
  const int n = model.num_particles();
  std::vector<char> is_pinned(n, 0);
  for (const int p : pinned_) is_pinned[p] = 1;
  SparseMatrix couplings;
  couplings.num_columns = n;
  std::vector<double> excess(least_.begin(), least_.end());
  for (int i = 0; i < n; ++i) {
    if (is_pinned[i]) excess[i] = 0;
    for (const auto& [j, c] : lists[i]) {
      if (is_pinned[i]) break;
      if (is_pinned[j]) {
        excess[i] += c;
      } else if (c > 0) {
        couplings.add_entry(j, c);
      }
    }
    couplings.end_row();
  }
  mesh_.build(couplings, excess);
}

void ScalarPreconditioner::fill_grid_by_springs(const ClothModel& model, double step) {
  GridLevel& level = grid_.finest();
  const ClothMaterial& m = model.material;
  const double damping = m.damping / step;
  const SpringModel spring_model = model.topology->spring_model;
  const double stiffening = 1 + m.damping_time / step;
  const auto along = [&](double stiffness) {
    return static_cast<float>(stiffening * stiffness + 4 * m.bend + 5 * damping);
  };
  const float along_x = along(m.structural), along_z = along(m.structural_z.value_or(m.structural));
  const auto shear = static_cast<float>(stiffening * m.shear + damping);
  const int columns = level.rows.row_length, num_rows = level.rows.num_rows;
  level.has_down_left = spring_model != SpringModel::simplified;
  const bool alternates = spring_model == SpringModel::alternating;
  for (int j = 0; j < num_rows; ++j) {
    const int first = level.rows.row(j);
    std::fill_n(level.right.begin() + first, columns - 1, along_x);
    if (j + 1 == num_rows) break;
    std::fill_n(level.down.begin() + first, columns, along_z);
    for (int i = 0; i < columns; ++i) {
      const float here = alternates && (i + j) % 2 == 1 ? 0.0f : shear;
      level.down_right[first + i] = i + 1 < columns ? here : 0.0f;
      if (level.has_down_left) level.down_left[first + i] = i > 0 ? here : 0.0f;
    }
  }
}

/// Structural springs and diagonals with their individual stiffness; bending springs, which are lumped into
/// the former, without factors.
void ScalarPreconditioner::scale_grid_springs(const ClothModel& model, double step,
                                              const std::vector<double>& added) {
  GridLevel& level = grid_.finest();
  const ClothMaterial& m = model.material;
  const std::vector<Spring>& springs = model.topology->springs;
  const int columns = level.rows.row_length;
  for (std::size_t s = 0; s < springs.size(); ++s) {
    const Spring& spring = springs[s];
    if (spring.kind == SpringKind::bend) continue;
    const bool is_structural = spring.kind == SpringKind::structural;
    const int offset = spring.j - spring.i;
    AlignedFloats& across = is_structural ? level.right : level.down_right;
    AlignedFloats& down = is_structural ? level.down : level.down_left;
    AlignedFloats& family = offset == (is_structural ? 1 : columns + 1) ? across : down;
    const bool is_along_z = is_structural && offset == columns;
    const double was = is_along_z ? m.structural_z.value_or(m.structural) : model.stiffness(spring.kind);
    const double more = (1 + m.damping_time / step) * (model.stiffness(static_cast<int>(s)) - was);
    family[level.rows.index(spring.i)] += static_cast<float>(more + (added.empty() ? 0.0 : added[s]));
  }
}

void ScalarPreconditioner::fill_grid_by_elements(const ClothElements& elements, double step,
                                                 const std::vector<double>& added) {
  GridLevel& level = grid_.finest();
  const std::vector<double> stiffness = coupling_stiffness(elements, step, added);
  const int columns = level.rows.row_length;
  level.has_down_left = false;
  for (AlignedFloats* family : {&level.right, &level.down, &level.down_right, &level.down_left})
    std::fill(family->begin(), family->end(), 0.0f);
  for (std::size_t k = 0; k < stiffness.size(); ++k) {
    const Coupling& c = elements.couplings[k];
    AlignedFloats& family = c.j == c.i + 1 ? level.right : level.down;
    if (c.j == c.i + 1 || c.j == c.i + columns)
      family[level.rows.index(c.i)] = static_cast<float>(stiffness[k]);
  }
}

/// Moves couplings to pins into the diagonal of the other end.
void ScalarPreconditioner::pin_grid() {
  GridLevel& level = grid_.finest();
  const int stride = level.rows.stride();
  ties_.clear();
  for (const int particle : pinned_) {
    const int p = level.rows.index(particle);
    const auto cut = [&](float& coupling, int neighbour) {
      if (coupling > 0) ties_.emplace_back(neighbour, coupling);
      coupling = 0;
    };
    cut(level.right[p], p + 1);
    cut(level.right[p - 1], p - 1);
    cut(level.down[p], p + stride);
    cut(level.down[p - stride], p - stride);
    cut(level.down_right[p], p + stride + 1);
    cut(level.down_right[p - stride - 1], p - stride - 1);
    cut(level.down_left[p], p + stride - 1);
    cut(level.down_left[p - stride + 1], p - stride + 1);
  }
}

double ScalarPreconditioner::apply(const Vec3Array& r, JobSystem& jobs, Vec3Array& z) {
  return is_grid_ ? grid_.apply(r, jobs, z) : mesh_.apply(r, first_, jobs, z);
}

}  // namespace weft::engine
