#pragma once
/// Bytes that are kept on disk for a while.

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

  /// Copies `count` bytes from `position` on, which are there.
  void read(std::size_t position, void* bytes, std::size_t count);

  /// Writes all bytes to `out`.
  void copy_to(std::ostream& out);

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  void seek(std::size_t position);

  std::filesystem::path target_;
  std::unique_ptr<std::FILE, Close> file_;
  std::size_t size_ = 0;
  bool is_at_end_ = true;  // of the file
};

}  // namespace weft::engine
