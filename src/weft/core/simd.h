#pragma once
/// Run-time dispatch of the kernels' vector instructions.
///
/// A kernel is one plain loop, compiled once per level by WEFT_MULTIVERSION and dispatched at run time. Every
/// lane does the same IEEE operations in the same order (no fused multiply-add, no estimates), so the level
/// changes the speed but no bit of the result.

#include <string_view>

namespace weft::engine {

enum class SimdLevel { baseline, avx2, avx512 };

/// Best level that this machine supports.
SimdLevel best_simd_level();

/// Level in use: the best one, unless limited.
SimdLevel simd_level();

/// Limits the level from now on (for tests and benchmarks; must not be called during a step).
void limit_simd_level(SimdLevel level);

std::string_view to_string(SimdLevel level);

}  // namespace weft::engine

// WEFT_MULTIVERSION(name, (parameters), (arguments)) defines `name(parameters)`, which forwards to the
// always-inlined function `name_body(arguments)` compiled for the level in use. All callees of the body must
// be inlined too, lambdas included, or they are compiled for the lowest level.
#if defined(__GNUC__)
#define WEFT_ALWAYS_INLINE [[gnu::always_inline]] inline
#define WEFT_INLINE_LAMBDA __attribute__((always_inline))
#else
#define WEFT_ALWAYS_INLINE inline
#define WEFT_INLINE_LAMBDA
#endif

// Before a loop without dependencies between iterations.
#if defined(__clang__)
#define WEFT_IVDEP _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define WEFT_IVDEP _Pragma("GCC ivdep")
#else
#define WEFT_IVDEP
#endif

// Baseline only under sanitizers: all levels share one body, and three copies compile very slowly.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define WEFT_HAS_SIMD_LEVELS 1
#else
#define WEFT_HAS_SIMD_LEVELS 0
#endif

#if WEFT_HAS_SIMD_LEVELS
#define WEFT_MULTIVERSION(name, parameters, arguments)                                             \
  [[gnu::target("arch=x86-64-v3")]] static void name##_avx2 parameters { name##_body arguments; }  \
  [[gnu::target("arch=x86-64-v4,prefer-vector-width=512")]] static void name##_avx512 parameters { \
    name##_body arguments;                                                                         \
  }                                                                                                \
  static void name##_baseline parameters { name##_body arguments; }                                \
  static void name parameters {                                                                    \
    switch (::weft::engine::simd_level()) {                                                        \
      case ::weft::engine::SimdLevel::avx512:                                                      \
        return name##_avx512 arguments;                                                            \
      case ::weft::engine::SimdLevel::avx2:                                                        \
        return name##_avx2 arguments;                                                              \
      case ::weft::engine::SimdLevel::baseline:                                                    \
        return name##_baseline arguments;                                                          \
    }                                                                                              \
  }
#else
#define WEFT_MULTIVERSION(name, parameters, arguments) \
  static void name parameters { name##_body arguments; }
#endif
