#pragma once
/// Contents of files, for tests.

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace weft::engine {

/// All bytes of a file; none of one that cannot be read.
inline std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace weft::engine
