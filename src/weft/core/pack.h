#pragma once
/// Packs of floats in a vector register, for kernels where auto-vectorised loops are too slow.
///
/// A kernel is a template over the width W; WEFT_MULTIVERSION_PACKS compiles it for 4, 8 and 16 lanes and
/// dispatches at run time. Results do not depend on W: elementwise work never does, and sums use LaneSums,
/// which has sixteen lanes for any W.

#include <cstddef>
#include <cstring>

#include "weft/core/simd.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"  // packs are never passed between functions: all are inlined
#endif

namespace weft::engine {

/// Rows of floats for packs are readable and writable up to a multiple of this [1].
constexpr int kPackLanes = 16;

constexpr int round_up_to_pack(int n) { return (n + kPackLanes - 1) / kPackLanes * kPackLanes; }

#if defined(__GNUC__)
template <int W>
struct PackOf {
  typedef float Type __attribute__((vector_size(4 * W)));
};
template <int W>
using Pack = typename PackOf<W>::Type;

/// Lane mask: all bits of a lane set, or none.
template <int W>
struct MaskOf {
  typedef int Type __attribute__((vector_size(4 * W)));
};
template <int W>
using Mask = typename MaskOf<W>::Type;

/// mask[lane] ? a[lane] : b[lane]
template <int W>
WEFT_ALWAYS_INLINE Pack<W> blend(Mask<W> mask, Pack<W> a, Pack<W> b) {
  return reinterpret_cast<Pack<W>>((reinterpret_cast<Mask<W>>(a) & mask) |
                                   (reinterpret_cast<Mask<W>>(b) & ~mask));
}

/// mask[lane] < bound[lane] ? a[lane] : b[lane]
template <class V>
WEFT_ALWAYS_INLINE V select_less(V value, V bound, V a, V b) {
  return value < bound ? a : b;
}

/// Whether a[lane] <= b[lane] in all four lanes.
WEFT_ALWAYS_INLINE bool are_at_most(Pack<4> a, Pack<4> b) {
  const Mask<4> is = a <= b;
  return (is[0] & is[1] & is[2] & is[3]) != 0;
}
#else
template <int W>
struct Pack {
  float lane[W] = {};

  float operator[](int l) const { return lane[l]; }
  float& operator[](int l) { return lane[l]; }
};

#define WEFT_PACK_OPERATOR(op)                              \
  template <int W>                                          \
  Pack<W> operator op(const Pack<W>& a, const Pack<W>& b) { \
    Pack<W> r;                                              \
    for (int l = 0; l < W; ++l) r[l] = a[l] op b[l];        \
    return r;                                               \
  }                                                         \
  template <int W>                                          \
  Pack<W> operator op(const Pack<W>& a, float b) {          \
    Pack<W> r;                                              \
    for (int l = 0; l < W; ++l) r[l] = a[l] op b;           \
    return r;                                               \
  }                                                         \
  template <int W>                                          \
  Pack<W> operator op(float a, const Pack<W>& b) {          \
    Pack<W> r;                                              \
    for (int l = 0; l < W; ++l) r[l] = a op b[l];           \
    return r;                                               \
  }                                                         \
  template <int W>                                          \
  Pack<W>& operator op##=(Pack<W>& a, const Pack<W>& b) {   \
    return a = a op b;                                      \
  }
WEFT_PACK_OPERATOR(+)
WEFT_PACK_OPERATOR(-)
WEFT_PACK_OPERATOR(*)
WEFT_PACK_OPERATOR(/)
#undef WEFT_PACK_OPERATOR

template <int W>
struct Mask {
  int lane[W] = {};

  int& operator[](int l) { return lane[l]; }
  Mask operator~() const {
    Mask r;
    for (int l = 0; l < W; ++l) r[l] = ~lane[l];
    return r;
  }
};

template <int W>
Pack<W> blend(const Mask<W>& mask, const Pack<W>& a, const Pack<W>& b) {
  Pack<W> r;
  for (int l = 0; l < W; ++l) r[l] = mask.lane[l] ? a[l] : b[l];
  return r;
}

template <int W>
Pack<W> select_less(const Pack<W>& value, const Pack<W>& bound, const Pack<W>& a, const Pack<W>& b) {
  Pack<W> r;
  for (int l = 0; l < W; ++l) r[l] = value[l] < bound[l] ? a[l] : b[l];
  return r;
}

inline bool are_at_most(const Pack<4>& a, const Pack<4>& b) {
  return a[0] <= b[0] && a[1] <= b[1] && a[2] <= b[2] && a[3] <= b[3];
}
#endif

template <int W>
WEFT_ALWAYS_INLINE Pack<W> load(const float* from) {
  Pack<W> v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

template <class V>
WEFT_ALWAYS_INLINE void store(float* to, V v) {
  std::memcpy(to, &v, sizeof v);
}

template <int W>
WEFT_ALWAYS_INLINE Pack<W> broadcast(float value) {
  return value + Pack<W>{};
}

/// first, first + 1, …
template <int W>
WEFT_ALWAYS_INLINE Pack<W> count_from(std::ptrdiff_t first) {
  Pack<W> lanes{};
  for (int l = 0; l < W; ++l) lanes[l] = static_cast<float>(l);
  return static_cast<float>(first) + lanes;
}

template <class V>
WEFT_ALWAYS_INLINE V larger(V a, V b) {
  return select_less(a, b, b, a);
}

template <class V>
WEFT_ALWAYS_INLINE V smaller(V a, V b) {
  return select_less(b, a, b, a);
}

/// The largest lane.
template <int W>
WEFT_ALWAYS_INLINE float widest(Pack<W> a) {
  float most = a[0];
  for (int l = 1; l < W; ++l) most = most < a[l] ? a[l] : most;
  return most;
}

/// 1 where first, first + 1, … is less than `end`, else 0. Without comparisons, which compilers scalarise
/// where both outcomes are constants.
template <int W>
WEFT_ALWAYS_INLINE Pack<W> count_below(std::ptrdiff_t end, std::ptrdiff_t first) {
  const Pack<W> left = static_cast<float>(end) - count_from<W>(first);
  return smaller(larger(left, broadcast<W>(0)), broadcast<W>(1));
}

/// Mask of the even numbers among first, first + 1, …
template <int W>
WEFT_ALWAYS_INLINE Mask<W> even_from(std::ptrdiff_t first) {
  Mask<W> even{};
  for (int l = 0; l < W; ++l) even[l] = (l & 1) == 0 ? -1 : 0;
  return (first & 1) == 0 ? even : ~even;
}

template <class V>
WEFT_ALWAYS_INLINE V magnitude(V a) {
  return larger(a, 0.0f - a);
}

template <class V>
WEFT_ALWAYS_INLINE V square_root(V a) {
  V r{};
  for (int l = 0; l < static_cast<int>(sizeof(V) / sizeof(float)); ++l) r[l] = __builtin_sqrtf(a[l]);
  return r;
}

/// Sums in sixteen lanes, added up in order at the end: the same bits for every W.
template <int W>
class LaneSums {
 public:
  static constexpr int kParts = kPackLanes / W;

  /// Adds to the lanes of the part-th pack of a block of sixteen.
  WEFT_ALWAYS_INLINE void add(int part, Pack<W> v) { sums_[part] += v; }

  WEFT_ALWAYS_INLINE double total() const {
    double sum = 0;
    for (int p = 0; p < kParts; ++p) {
      for (int l = 0; l < W; ++l) sum += static_cast<double>(sums_[p][l]);
    }
    return sum;
  }

 private:
  Pack<W> sums_[kParts] = {};
};

/// Calls body(i, part) for the packs of [0, count), count rounded up to a block of sixteen.
template <int W, class Body>
WEFT_ALWAYS_INLINE void for_packs(std::ptrdiff_t count, const Body& body) {
  for (std::ptrdiff_t block = 0; block < count; block += kPackLanes) {
#if defined(__GNUC__)
#pragma GCC unroll 4
#endif
    for (int part = 0; part < kPackLanes / W; ++part) body(block + part * W, part);
  }
}

}  // namespace weft::engine

// WEFT_MULTIVERSION_PACKS(name, (parameters), (arguments)): as WEFT_MULTIVERSION, for a body that is a
// template over the pack width.
#if WEFT_HAS_SIMD_LEVELS
#define WEFT_MULTIVERSION_PACKS(name, parameters, arguments)                                         \
  [[gnu::target("arch=x86-64-v3")]] static void name##_avx2 parameters { name##_body<8> arguments; } \
  [[gnu::target("arch=x86-64-v4,prefer-vector-width=512")]] static void name##_avx512 parameters {   \
    name##_body<16> arguments;                                                                       \
  }                                                                                                  \
  static void name##_baseline parameters { name##_body<4> arguments; }                               \
  static void name parameters {                                                                      \
    switch (::weft::engine::simd_level()) {                                                          \
      case ::weft::engine::SimdLevel::avx512:                                                        \
        return name##_avx512 arguments;                                                              \
      case ::weft::engine::SimdLevel::avx2:                                                          \
        return name##_avx2 arguments;                                                                \
      case ::weft::engine::SimdLevel::baseline:                                                      \
        return name##_baseline arguments;                                                            \
    }                                                                                                \
  }
#else
#define WEFT_MULTIVERSION_PACKS(name, parameters, arguments) \
  static void name parameters { name##_body<4> arguments; }
#endif
