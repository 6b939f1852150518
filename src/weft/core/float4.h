#pragma once
/// Four floats in one register, for bounds and candidate lists. Eigen's own do not use vectors here (core/vec.h).

#include <algorithm>
#include <cmath>

#include "weft/core/pack.h"
#include "weft/core/vec.h"

namespace weft::engine {

/// A point or a vector; the last component is 0 and pads the register. Names are Eigen's. Sums add (0 + 1) + (2 + 3).
class Float4 {
 public:
  Float4() = default;
  Float4(float x, float y, float z, float w) : lanes_{x, y, z, w} {}
  static Float4 Constant(float value) { return {value, value, value, value}; }
  static Float4 Zero() { return Constant(0); }

  float operator[](int lane) const { return lanes_[lane]; }
  void set(int lane, float value) { lanes_[lane] = value; }
  Eigen::Vector3f xyz() const { return {lanes_[0], lanes_[1], lanes_[2]}; }

  Float4 operator-() const { return -1.0f * *this; }
  Float4 operator+(const Float4& b) const { return Float4(lanes_ + b.lanes_); }
  Float4 operator-(const Float4& b) const { return Float4(lanes_ - b.lanes_); }
  Float4 operator/(float b) const { return Float4(lanes_ / Constant(b).lanes_); }
  friend Float4 operator*(float a, const Float4& b) { return Float4(Constant(a).lanes_ * b.lanes_); }
  Float4& operator+=(const Float4& b) { return *this = *this + b; }
  Float4& operator-=(const Float4& b) { return *this = *this - b; }
  Float4& operator/=(float b) { return *this = *this / b; }

  Float4 cwiseMin(const Float4& b) const { return Float4(select_less(b.lanes_, lanes_, b.lanes_, lanes_)); }
  Float4 cwiseMax(const Float4& b) const { return Float4(select_less(lanes_, b.lanes_, b.lanes_, lanes_)); }
  Float4 cwiseAbs() const { return Float4(select_less(lanes_, Zero().lanes_, (-*this).lanes_, lanes_)); }
  float maxCoeff() const { return std::max(std::max(lanes_[0], lanes_[1]), std::max(lanes_[2], lanes_[3])); }

  /// Whether every component is at most that of b.
  bool is_at_most(const Float4& b) const { return are_at_most(lanes_, b.lanes_); }

  float dot(const Float4& b) const {
    const Pack<4> product = lanes_ * b.lanes_;
    return (product[0] + product[1]) + (product[2] + product[3]);
  }
  float squaredNorm() const { return dot(*this); }
  float norm() const { return std::sqrt(squaredNorm()); }

 private:
  explicit Float4(const Pack<4>& lanes) : lanes_(lanes) {}

  Pack<4> lanes_;
};

}  // namespace weft::engine
