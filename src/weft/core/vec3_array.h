#pragma once
/// Arrays of 3-vectors as structure of arrays of floats in one block of memory, for the fast kernels.

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "weft/core/aligned.h"
#include "weft/core/vec.h"

namespace weft::engine {

class Vec3Array {
 public:
  /// Readable zeros after the last element, so that kernels may process full vector registers.
  static constexpr std::size_t kPadding = 32;

  Vec3Array() = default;
  explicit Vec3Array(std::size_t n) { resize(n); }
  Vec3Array(const Vec3Array& other) { *this = other; }
  Vec3Array(Vec3Array&& other) noexcept { swap(other); }

  /// Keeps the memory where its size allows, so that views of it show the new values.
  Vec3Array& operator=(const Vec3Array& other) {
    if (this == &other) return *this;
    size_ = other.size_;
    stride_ = other.stride_;
    if (stride_ == 0) return *this;
    if (!memory_ || memory_->size() != 3 * stride_) allocate(size_);
    std::copy_n(other.first_, 3 * stride_, first_);
    return *this;
  }
  Vec3Array& operator=(Vec3Array&& other) noexcept {
    swap(other);
    return *this;
  }

  std::size_t size() const { return size_; }
  std::size_t stride() const { return stride_; }  // from x to y, and from y to z [floats]

  /// Keeps the elements up to the smaller size; new ones, and the padding, are zero.
  void resize(std::size_t n) {
    if (n == size_ && memory_) {
      for (float* component : {x(), y(), z()}) std::fill(component + n, component + stride_, 0.0f);
      return;
    }
    Vec3Array next;
    next.allocate(n);
    const std::size_t kept = std::min(n, size_);
    for (const std::size_t component : {0, 1, 2})
      std::copy_n(first_ + component * stride_, kept, next.first_ + component * next.stride_);
    swap(next);
  }

  float* x() { return first_; }
  float* y() { return first_ + stride_; }
  float* z() { return first_ + 2 * stride_; }
  const float* x() const { return first_; }
  const float* y() const { return first_ + stride_; }
  const float* z() const { return first_ + 2 * stride_; }

  Vec3 get(std::size_t i) const { return {x()[i], y()[i], z()[i]}; }

  void set(std::size_t i, const Vec3& value) {
    x()[i] = static_cast<float>(value.x());
    y()[i] = static_cast<float>(value.y());
    z()[i] = static_cast<float>(value.z());
  }

  /// The memory, which lives as long as this pointer or the array has it.
  std::shared_ptr<const float> share() const { return {memory_, first_}; }

 private:
  void allocate(std::size_t n) {
    size_ = n;
    stride_ = (n + kPadding + kLine - 1) / kLine * kLine;
    memory_ = std::make_shared<AlignedFloats>(3 * stride_, 0.0f);
    first_ = memory_->data();
  }

  void swap(Vec3Array& other) noexcept {
    std::swap(size_, other.size_);
    std::swap(stride_, other.stride_);
    std::swap(first_, other.first_);
    memory_.swap(other.memory_);
  }

  static constexpr std::size_t kLine = 16;  // floats of a cache line

  std::size_t size_ = 0, stride_ = 0;
  float* first_ = nullptr;                 // of `memory_`
  std::shared_ptr<AlignedFloats> memory_;  // x, then y, then z, with padding (3 x stride_); null: empty
};

inline std::vector<Vec3> to_doubles(const Vec3Array& values) {
  std::vector<Vec3> doubles;
  doubles.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) doubles.push_back(values.get(i));
  return doubles;
}

}  // namespace weft::engine
