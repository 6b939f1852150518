#pragma once
/// Bytes that are kept on disk until they are copied elsewhere.

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <ostream>

namespace weft::engine {

/// A temporary file without a name: it is gone when this, or the process, ends. Every error is an InputError
/// with the name of the file that the bytes are for, and the system's reason.
class SpoolFile {
 public:
  /// Beside `target`, or in the system's folder for temporary files where that cannot be written.
  explicit SpoolFile(const std::filesystem::path& target);

  void append(const void* bytes, std::size_t count);
  std::size_t size() const { return size_; }  // [bytes]

  /// Writes all bytes to `out`. Nothing is appended afterwards.
  void copy_to(std::ostream& out);

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  std::filesystem::path target_;
  std::unique_ptr<std::FILE, Close> file_;
  std::size_t size_ = 0;
};

}  // namespace weft::engine
