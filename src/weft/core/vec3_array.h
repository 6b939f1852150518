#pragma once
/// Arrays of 3-vectors as structure of arrays of floats, for the fast kernels.

#include <cstddef>

#include "weft/core/aligned.h"
#include "weft/core/vec.h"

namespace weft::engine {

class Vec3Array {
 public:
  /// Readable zeros after the last element, so that kernels may process full vector registers.
  static constexpr std::size_t kPadding = 32;

  Vec3Array() = default;
  explicit Vec3Array(std::size_t n) { resize(n); }

  std::size_t size() const { return size_; }

  void resize(std::size_t n) {
    size_ = n;
    for (auto* component : {&x_, &y_, &z_}) {
      component->resize(n);
      component->resize(n + kPadding, 0.0f);
    }
  }

  float* x() { return x_.data(); }
  float* y() { return y_.data(); }
  float* z() { return z_.data(); }
  const float* x() const { return x_.data(); }
  const float* y() const { return y_.data(); }
  const float* z() const { return z_.data(); }

  Vec3 get(std::size_t i) const { return {x_[i], y_[i], z_[i]}; }

  void set(std::size_t i, const Vec3& value) {
    x_[i] = static_cast<float>(value.x());
    y_[i] = static_cast<float>(value.y());
    z_[i] = static_cast<float>(value.z());
  }

 private:
  std::size_t size_ = 0;
  AlignedFloats x_, y_, z_;  // (size_ + kPadding) each
};

}  // namespace weft::engine
