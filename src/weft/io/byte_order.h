#pragma once
/// Numbers as bytes in either byte order.

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string>

namespace weft::engine {

/// The number whose bytes begin at `from`.
template <class T>
T number_from_bytes(const char* from, std::endian order) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), from, bytes.size());
  if (order != std::endian::native) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

template <class T>
void append_bytes(T number, std::endian order, std::string& bytes) {
  auto added = std::bit_cast<std::array<char, sizeof(T)>>(number);
  if (order != std::endian::native) std::reverse(added.begin(), added.end());
  bytes.append(added.data(), added.size());
}

}  // namespace weft::engine
