#include "weft/integrators/newton_kernels.h"

#include <algorithm>

#include "weft/core/simd.h"

namespace weft::engine {
namespace {

constexpr int kGrain = 4096;  // particles per chunk of work

/// body(particle, place, count) for runs of particles that are contiguous in the padded arrays.
template <class Body>
void for_runs(JobSystem& jobs, const PaddedRows& rows, const Body& body) {
  if (rows.num_rows == 1) {
    parallel_for(jobs, rows.row_length, kGrain,
                 [&](int begin, int end) { body(begin, rows.row(0) + begin, end - begin); });
    return;
  }
  parallel_for(jobs, rows.num_rows, std::max(1, kGrain / rows.row_length), [&](int begin, int end) {
    for (int j = begin; j < end; ++j) body(j * rows.row_length, rows.row(j), rows.row_length);
  });
}

struct Prediction {
  float memory, drag_factor, velocity_gain, time;  // time: h/β
};

WEFT_ALWAYS_INLINE void predict_run_body(const Prediction& a, int count, const float* x, float* v, float* s,
                                         float* v_before, float* y) {
  WEFT_IVDEP
  for (int i = 0; i < count; ++i) {
    const float old = v[i];
    const float now = a.drag_factor * (old + a.memory * (old - v_before[i])) + a.velocity_gain;
    const float moved = a.memory * s[i] + a.time * now;
    v_before[i] = old;
    v[i] = now;
    s[i] = moved;
    y[i] = x[i] + moved;
  }
}

WEFT_MULTIVERSION(predict_run,
                  (const Prediction& a, int count, const float* x, float* v, float* s, float* v_before,
                   float* y),
                  (a, count, x, v, s, v_before, y))

WEFT_ALWAYS_INLINE void correct_run_body(float rate, int count, const float* d, float* x, float* v,
                                         float* s) {
  WEFT_IVDEP
  for (int i = 0; i < count; ++i) {
    v[i] += rate * d[i];
    s[i] += d[i];
    x[i] += s[i];
  }
}

WEFT_MULTIVERSION(correct_run, (float rate, int count, const float* d, float* x, float* v, float* s),
                  (rate, count, d, x, v, s))

WEFT_ALWAYS_INLINE void add_run_body(const float* y, float share, const float* d, int begin, int end,
                                     float* x) {
  WEFT_IVDEP
  for (int i = begin; i < end; ++i) x[i] = y[i] + share * d[i];
}

WEFT_MULTIVERSION(add_run, (const float* y, float share, const float* d, int begin, int end, float* x),
                  (y, share, d, begin, end, x))

}  // namespace

StepScheme make_bdf2(double step, double step_before) {
  const double r = step / step_before;
  return {.step = step, .beta = (1 + 2 * r) / (1 + r), .memory = r * r / (1 + 2 * r)};
}

void predict(const StepScheme& scheme, const PaddedRows& rows, JobSystem& jobs, ClothState& state,
             Vec3Array& y) {
  const auto run = [&](int c, const float* x, float* v, float* s, float* v_before, float* to) {
    const Prediction a{static_cast<float>(scheme.memory), static_cast<float>(scheme.drag_factor),
                       static_cast<float>(scheme.velocity_gain[c]),
                       static_cast<float>(scheme.step / scheme.beta)};
    for_runs(jobs, rows, [&](int p, int place, int count) {
      predict_run(a, count, x + p, v + p, s + p, v_before + p, to + place);
    });
  };
  MotionHistory& h = state.history;
  run(0, state.x.x(), state.v.x(), h.displacement.x(), h.velocity.x(), y.x());
  run(1, state.x.y(), state.v.y(), h.displacement.y(), h.velocity.y(), y.y());
  run(2, state.x.z(), state.v.z(), h.displacement.z(), h.velocity.z(), y.z());
}

void correct(const StepScheme& scheme, const PaddedRows& rows, const Vec3Array& d, JobSystem& jobs,
             ClothState& state) {
  const auto rate = static_cast<float>(scheme.beta / scheme.step);
  const auto run = [&](const float* by, float* x, float* v, float* s) {
    for_runs(jobs, rows,
             [&](int p, int place, int count) { correct_run(rate, count, by + place, x + p, v + p, s + p); });
  };
  Vec3Array& s = state.history.displacement;
  run(d.x(), state.x.x(), state.v.x(), s.x());
  run(d.y(), state.x.y(), state.v.y(), s.y());
  run(d.z(), state.x.z(), state.v.z(), s.z());
}

void add_scaled(const Vec3Array& y, double share, const Vec3Array& d, JobSystem& jobs, Vec3Array& x) {
  const auto a = static_cast<float>(share);
  parallel_for(jobs, static_cast<int>(y.size()), 4 * kGrain, [&](int begin, int end) {
    add_run(y.x(), a, d.x(), begin, end, x.x());
    add_run(y.y(), a, d.y(), begin, end, x.y());
    add_run(y.z(), a, d.z(), begin, end, x.z());
  });
}

}  // namespace weft::engine
