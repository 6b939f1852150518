#pragma once
/// FNV-1a over bytes: small, permanently fixed, sufficient to distinguish two states.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

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

/// The hash of a range of plain numbers.
template <class T>
std::uint64_t hash_of(std::span<const T> values) {
  Hash hash;
  hash.add(values);
  return hash.value();
}

/// Sixteen hexadecimal digits.
inline std::string to_hex(std::uint64_t value) {
  std::string digits(16, '0');
  for (auto digit = digits.rbegin(); digit != digits.rend(); ++digit, value /= 16)
    *digit = "0123456789abcdef"[value % 16];
  return digits;
}

}  // namespace weft::engine
