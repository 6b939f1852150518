#pragma once
/// Private to forces/: packs of 3-vectors for the kernels.

#include "weft/core/pack.h"
#include "weft/forces/increments_kernels.h"

namespace weft::engine::kernels {

template <int W>
struct Three {
  Pack<W> x, y, z;
};

template <int W>
WEFT_ALWAYS_INLINE Three<W> load3(ConstRows a, std::ptrdiff_t i) {
  return {load<W>(a.x + i), load<W>(a.y + i), load<W>(a.z + i)};
}

template <int W>
WEFT_ALWAYS_INLINE void store3(Rows a, std::ptrdiff_t i, const Three<W>& v) {
  store(a.x + i, v.x);
  store(a.y + i, v.y);
  store(a.z + i, v.z);
}

template <int W>
WEFT_ALWAYS_INLINE Pack<W> gather(const float* from, const int* index) {
  Pack<W> v{};
  for (int l = 0; l < W; ++l) v[l] = from[index[l]];
  return v;
}

template <int W>
WEFT_ALWAYS_INLINE Three<W> gather3(ConstRows a, int first, const int* index) {
  return {gather<W>(a.x + first, index), gather<W>(a.y + first, index), gather<W>(a.z + first, index)};
}

template <int W>
WEFT_ALWAYS_INLINE Pack<W> dot(const Three<W>& a, const Three<W>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <int W>
WEFT_ALWAYS_INLINE Three<W> plus(const Three<W>& a, const Three<W>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

template <int W>
WEFT_ALWAYS_INLINE Three<W> minus(const Three<W>& a, const Three<W>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

/// s a, for a number or a pack s.
template <int W, class S>
WEFT_ALWAYS_INLINE Three<W> times(S s, const Three<W>& a) {
  return {s * a.x, s * a.y, s * a.z};
}

}  // namespace weft::engine::kernels
