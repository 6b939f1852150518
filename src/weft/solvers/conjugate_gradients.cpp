#include "weft/solvers/conjugate_gradients.h"

#include <algorithm>

#include "weft/core/simd.h"

namespace weft::engine {
namespace {

constexpr int kGrain = 16384;  // numbers per chunk of work

WEFT_ALWAYS_INLINE void turn_multi_body(float beta, const float* z, float* p, int begin, int end) {
  WEFT_IVDEP
  for (int i = begin; i < end; ++i) p[i] = z[i] + beta * p[i];
}

WEFT_MULTIVERSION(turn_multi, (float beta, const float* z, float* p, int begin, int end),
                  (beta, z, p, begin, end))

WEFT_ALWAYS_INLINE void advance_multi_body(float alpha, const float* p, const float* q, float* x, float* r,
                                           int begin, int end) {
  WEFT_IVDEP
  for (int i = begin; i < end; ++i) {
    x[i] += alpha * p[i];
    r[i] -= alpha * q[i];
  }
}

WEFT_MULTIVERSION(advance_multi,
                  (float alpha, const float* p, const float* q, float* x, float* r, int begin, int end),
                  (alpha, p, q, x, r, begin, end))

void clear(Vec3Array& a) {
  for (float* component : {a.x(), a.y(), a.z()}) std::fill(component, component + a.size(), 0.0f);
}

}  // namespace

void CgBlock::begin() {
  residual = *b;
  if (x->size() != b->size()) x->resize(b->size());
  clear(*x);
  if (direction.size() != b->size()) {
    for (Vec3Array* field : {&preconditioned, &direction, &product}) *field = Vec3Array(b->size());
  }
  clear(direction);
}

void CgBlock::turn(double beta, JobSystem& jobs) {
  const auto scale = static_cast<float>(beta);
  Vec3Array &z = preconditioned, &p = direction;
  parallel_for(jobs, static_cast<int>(p.size()), kGrain, [&](int begin, int end) {
    turn_multi(scale, z.x(), p.x(), begin, end);
    turn_multi(scale, z.y(), p.y(), begin, end);
    turn_multi(scale, z.z(), p.z(), begin, end);
  });
}

void CgBlock::advance(double alpha, JobSystem& jobs) {
  const auto share = static_cast<float>(alpha);
  Vec3Array &p = direction, &q = product, &r = residual;
  parallel_for(jobs, static_cast<int>(p.size()), kGrain, [&](int begin, int end) {
    advance_multi(share, p.x(), q.x(), x->x(), r.x(), begin, end);
    advance_multi(share, p.y(), q.y(), x->y(), r.y(), begin, end);
    advance_multi(share, p.z(), q.z(), x->z(), r.z(), begin, end);
  });
}

}  // namespace weft::engine
