#include "tools/wardrobe/isosurface.h"

#include <algorithm>
#include <map>
#include <optional>

#include "weft/mesh/clean.h"

namespace weft::engine::wardrobe {
namespace {

/// Samples of a field at the corners of cells.
class Samples {
 public:
  Samples(const Field& field, const Eigen::AlignedBox3d& box, double cell) : low_(box.min()), cell_(cell) {
    for (int axis = 0; axis < 3; ++axis) size_[axis] = 2 + static_cast<int>(box.sizes()[axis] / cell);
    values_.reserve(static_cast<std::size_t>(size_[0]) * size_[1] * size_[2]);
    for (int k = 0; k < size_[2]; ++k) {
      for (int j = 0; j < size_[1]; ++j) {
        for (int i = 0; i < size_[0]; ++i) values_.push_back(field(place(i, j, k)));
      }
    }
  }

  const std::array<int, 3>& size() const { return size_; }
  int index(int i, int j, int k) const { return (k * size_[1] + j) * size_[0] + i; }
  int stride(int axis) const { return axis == 0 ? 1 : axis == 1 ? size_[0] : size_[0] * size_[1]; }
  Vec3 place(int i, int j, int k) const { return low_ + cell_ * Vec3(i, j, k); }
  bool is_inside(int index) const { return values_[index] < 0; }

  /// Mean of the zeros on the edges of the cell with this lowest corner; empty if there are none.
  std::optional<Vec3> find_middle(int i, int j, int k) const {
    Vec3 sum = Vec3::Zero();
    int count = 0;
    for (int axis = 0; axis < 3; ++axis) {
      for (int side = 0; side < 4; ++side) {
        std::array<int, 3> at = {i, j, k};
        at[(axis + 1) % 3] += side & 1;
        at[(axis + 2) % 3] += side >> 1;
        const int a = index(at[0], at[1], at[2]), b = a + stride(axis);
        if (is_inside(a) == is_inside(b)) continue;
        Vec3 zero = place(at[0], at[1], at[2]);
        zero[axis] += cell_ * values_[a] / (values_[a] - values_[b]);
        sum += zero;
        ++count;
      }
    }
    return count > 0 ? std::optional<Vec3>(sum / count) : std::nullopt;
  }

 private:
  Vec3 low_;
  double cell_;
  std::array<int, 3> size_{};
  std::vector<double> values_;
};

/// A step of Newton's method along the gradient.
Vec3 draw_on(const Field& field, const Vec3& p, double cell) {
  const double h = 0.01 * cell;
  Vec3 gradient;
  for (int axis = 0; axis < 3; ++axis)
    gradient[axis] = (field(p + h * Vec3::Unit(axis)) - field(p - h * Vec3::Unit(axis))) / (2 * h);
  Vec3 step = -field(p) / std::max(gradient.squaredNorm(), 1e-6) * gradient;
  if (step.norm() > 0.3 * cell) step *= 0.3 * cell / step.norm();
  return p + step;
}

/// Rounds to whole micrometres.
Vec3 rounded(const Vec3& x) { return (x * 1e6).array().round() / 1e6 + 0.0; }

void add_quad(const std::array<int, 4>& v, TriangleMesh& mesh) {
  const auto& x = mesh.positions;
  if ((x[v[0]] - x[v[2]]).norm() < (x[v[1]] - x[v[3]]).norm()) {
    mesh.triangles.insert(mesh.triangles.end(), {{v[0], v[1], v[2]}, {v[0], v[2], v[3]}});
  } else {
    mesh.triangles.insert(mesh.triangles.end(), {{v[0], v[1], v[3]}, {v[1], v[2], v[3]}});
  }
}

}  // namespace

TriangleMesh build_isosurface(const Field& field, const Eigen::AlignedBox3d& box, double cell) {
  const Samples samples(field, box, cell);
  const auto [nx, ny, nz] = samples.size();
  TriangleMesh mesh;
  std::vector<int> vertex(static_cast<std::size_t>(nx) * ny * nz, -1);  // (cells) by their lowest corner
  for (int k = 0; k + 1 < nz; ++k) {
    for (int j = 0; j + 1 < ny; ++j) {
      for (int i = 0; i + 1 < nx; ++i) {
        const std::optional<Vec3> middle = samples.find_middle(i, j, k);
        if (!middle) continue;
        Vec3 p = *middle;
        for (int step = 0; step < 4; ++step) p = draw_on(field, p, cell);
        vertex[samples.index(i, j, k)] = mesh.num_vertices();
        mesh.positions.push_back(rounded(p));
      }
    }
  }
  for (int k = 1; k + 1 < nz; ++k) {  // a quad across each edge with a zero
    for (int j = 1; j + 1 < ny; ++j) {
      for (int i = 1; i + 1 < nx; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
          const int a = samples.index(i, j, k);
          const int d1 = samples.stride((axis + 1) % 3), d2 = samples.stride((axis + 2) % 3);
          const bool is_in = samples.is_inside(a);
          if (is_in == samples.is_inside(a + samples.stride(axis))) continue;
          std::array<int, 4> quad = {vertex[a - d1 - d2], vertex[a - d2], vertex[a], vertex[a - d1]};
          if (!is_in) std::swap(quad[1], quad[3]);
          add_quad(quad, mesh);
        }
      }
    }
  }
  return mesh;
}

TriangleMesh clip(const TriangleMesh& mesh, const HalfSpace& kept, double snap) {
  TriangleMesh result;
  result.positions = mesh.positions;
  std::vector<double> height;  // (vertices) above the border
  for (Vec3& p : result.positions) {
    double above = kept.normal.dot(p) - kept.offset;
    if (std::abs(above) < snap) {
      p = rounded(p - above * kept.normal);
      above = 0;
    }
    height.push_back(above);
  }
  std::map<std::array<int, 2>, int> cuts;
  const auto cut = [&](int a, int b) {
    const auto [known, is_new] = cuts.try_emplace({std::min(a, b), std::max(a, b)}, result.num_vertices());
    if (is_new) {
      const double t = height[a] / (height[a] - height[b]);
      result.positions.push_back(
          rounded(result.positions[a] + t * (result.positions[b] - result.positions[a])));
    }
    return known->second;
  };
  for (const Triangle& t : mesh.triangles) {
    std::vector<int> polygon;
    for (int c = 0; c < 3; ++c) {
      const int a = t[c], b = t[(c + 1) % 3];
      if (height[a] <= 0) polygon.push_back(a);
      if (height[a] * height[b] < 0) polygon.push_back(cut(a, b));
    }
    if (std::none_of(t.begin(), t.end(), [&](int v) { return height[v] < 0; })) continue;
    for (std::size_t c = 2; c < polygon.size(); ++c)
      result.triangles.push_back({polygon[0], polygon[c - 1], polygon[c]});
  }
  return clean_mesh(result, {.is_cloth = false}).mesh;
}

std::vector<Vec3> compute_normals(const TriangleMesh& mesh) {
  std::vector<Vec3> normals(mesh.positions.size(), Vec3::Zero());
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 area = (mesh.positions[j] - mesh.positions[i]).cross(mesh.positions[k] - mesh.positions[i]);
    for (const int v : {i, j, k}) normals[v] += area;
  }
  for (Vec3& n : normals) n.stableNormalize();
  return normals;
}

void append(TriangleMesh& mesh, const TriangleMesh& other) {
  const int first = mesh.num_vertices();
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
}

}  // namespace weft::engine::wardrobe
