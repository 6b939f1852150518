#pragma once
/// FNV-1a over bytes: small, permanently fixed, sufficient to distinguish two states.

#include <cstdint>
#include <span>

namespace weft::engine {

class Hash {
 public:
  /// Adds the bit patterns of a range of plain numbers.
  template <class T>
  void add(std::span<const T> values) {
    const auto bytes = std::as_bytes(values);
    for (const std::byte b : bytes) value_ = (value_ ^ static_cast<std::uint64_t>(b)) * 0x100000001b3ULL;
  }

  template <class T>
  void add(const T& value) {
    add(std::span<const T>(&value, 1));
  }

  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

}  // namespace weft::engine
