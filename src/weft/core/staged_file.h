#pragma once
/// Atomic replacement of files.

#include <filesystem>
#include <fstream>
#include <ostream>
#include <string>
#include <string_view>

namespace weft::engine {

/// New content for a file: written to `.NAME.partial` in the same folder, then renamed over the old one. The
/// old content stays intact until replace() returns. A partial file left by a terminated program is
/// overwritten. Pipes, devices and standard output have no old content: they are written directly. Every
/// error is an InputError with the file's name and the system's reason.
class StagedFile {
 public:
  explicit StagedFile(const std::filesystem::path& file);

  /// Removes the partial file if replace() was not called.
  ~StagedFile();

  StagedFile(const StagedFile&) = delete;
  StagedFile& operator=(const StagedFile&) = delete;

  const std::filesystem::path& file() const { return file_; }
  std::ostream& out() { return standard_ ? *standard_ : stream_; }

  /// Completes the new content: flushes it to disk (fsync). Call once, before replace().
  void finish();

  /// Renames the new content over the old; symbolic links and the old file's permissions are kept.
  void replace();

 private:
  bool is_direct() const { return part_.empty(); }

  std::filesystem::path file_;
  std::filesystem::path target_, part_;  // links resolved; both empty for directly written files
  std::ofstream stream_;
  std::ostream* standard_ = nullptr;  // replaces stream_ for standard output and error
};

/// Replaces the file's content. Throws InputError, and keeps the old content, if it cannot be written.
void write_file(const std::filesystem::path& file, std::string_view content);

/// Throws InputError if StagedFile could not replace the file now. Does not change a file or pipe.
void require_writable(const std::filesystem::path& file);

}  // namespace weft::engine
