#pragma once
/// .glb files from fuzzer input that begins as text: the bytes up to the first zero are the JSON chunk, the rest
/// the binary chunk. The fuzzer therefore need not keep chunk lengths consistent.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

inline void append_word(std::vector<unsigned char>& bytes, std::size_t word) {
  for (int k = 0; k < 4; ++k) bytes.push_back(static_cast<unsigned char>(word >> (8 * k)));
}

inline void append_chunk(std::vector<unsigned char>& bytes, std::size_t kind, const std::uint8_t* begin,
                         const std::uint8_t* end, unsigned char padding) {
  const std::size_t size = static_cast<std::size_t>(end - begin), padded = (size + 3) / 4 * 4;
  append_word(bytes, padded);
  append_word(bytes, kind);
  bytes.insert(bytes.end(), begin, end);
  bytes.insert(bytes.end(), padded - size, padding);
}

inline std::vector<unsigned char> make_glb(const std::uint8_t* data, std::size_t size) {
  const std::uint8_t* end_of_text = std::find(data, data + size, 0);
  std::vector<unsigned char> bytes = {'g', 'l', 'T', 'F', 2, 0, 0, 0, 0, 0, 0, 0};
  append_chunk(bytes, 0x4E4F534A, data, end_of_text, ' ');
  if (end_of_text != data + size) append_chunk(bytes, 0x004E4942, end_of_text + 1, data + size, 0);
  for (int k = 0; k < 4; ++k) bytes[8 + k] = static_cast<unsigned char>(bytes.size() >> (8 * k));
  return bytes;
}
