#pragma once
/// Private to forces/: data that increments.cpp passes to the grid and mesh kernels.

#include <cmath>

#include "weft/core/simd.h"
#include "weft/forces/increments.h"

namespace weft::engine::kernels {

/// Elastic and projected damping force on i of a spring with d = x_j − x_i and w = v_j − v_i, as a factor of
/// d [N/m]: [k (l − l0) l + b w·d] / l². Zero times d for a spring of length zero, and in the padding of
/// tables.
template <bool kProjected>
WEFT_ALWAYS_INLINE float pull(float k, float rest_length, float b, float dx, float dy, float dz, float wx,
                              float wy, float wz) {
  constexpr float kMinLengthSq = 1e-30f;
  const float length_sq = dx * dx + dy * dy + dz * dz;
  const float length = std::sqrt(length_sq);
  float work = k * (length - rest_length) * length;
  if (kProjected) work += b * (wx * dx + wy * dy + wz * dz);
  return work / (length_sq > kMinLengthSq ? length_sq : kMinLengthSq);
}

/// Three float arrays.
struct Rows {
  float *x, *y, *z;
};

struct ConstRows {
  const float *x, *y, *z;
};

inline Rows rows(Vec3Array& a) { return {a.x(), a.y(), a.z()}; }
inline ConstRows rows(const Vec3Array& a) { return {a.x(), a.y(), a.z()}; }

/// Stiffness and rest length of one family of equal springs.
struct Family {
  float stiffness, rest_length;
};

struct GridStencil {
  int num_columns, num_rows;
  Family across, down, diagonal, bend_across, bend_down;
};

/// Settings in floats.
struct Forcing {
  float step, damping_plain, damping_projected, stiffness_damping, wind_rate;
  float ax, ay, az;  // uniform acceleration, with that of the wind's velocity
};

/// Start of row 0 of an IncrementField, and the distance between rows.
struct FieldLayout {
  int first, stride;
};

void grid_increments(const GridStencil& stencil, SpringModel model, const Forcing& forcing, ConstRows x,
                     ConstRows v, const float* mass, const float* weight, FieldLayout layout, Rows u,
                     int row_begin, int row_end);

void grid_filtered(const GridStencil& stencil, SpringModel model, float step, const float* weight,
                   const Outside& outside, FieldLayout layout, ConstRows u, Rows x, Rows v, int row_begin,
                   int row_end);

void mesh_increments(const ClothModel& model, const Forcing& forcing, ConstRows x, ConstRows v,
                     const float* mass, const float* weight, Rows u, int slice_begin, int slice_end);

void mesh_filtered(const ClothModel& model, float step, const float* weight, const Outside& outside,
                   ConstRows u, Rows x, Rows v, int slice_begin, int slice_end);

}  // namespace weft::engine::kernels
