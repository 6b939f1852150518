#pragma once
/// Files that are replaced whole or not at all.

#include <filesystem>
#include <fstream>
#include <ostream>
#include <string>
#include <string_view>

namespace weft::engine {

/// New content for a file: written aside in the same folder (`.NAME.partial`), then renamed over the old one.
/// Until replace() has returned, the old content stays, whatever happens. A partial file that an ended
/// program left is overwritten. Pipes, devices and standard output have no old content: they are written
/// directly. Every error is an InputError with the file's name and the system's reason.
class StagedFile {
 public:
  explicit StagedFile(const std::filesystem::path& file);

  /// Without replace() the partial file goes.
  ~StagedFile();

  StagedFile(const StagedFile&) = delete;
  StagedFile& operator=(const StagedFile&) = delete;

  const std::filesystem::path& file() const { return file_; }
  std::ostream& out() { return standard_ ? *standard_ : stream_; }

  /// The new content is complete: takes it to the disk (fsync). Called once, before replace().
  void finish();

  /// Renames the new content over the old; a symbolic link and the old file's permissions stay.
  void replace();

 private:
  bool is_direct() const { return part_.empty(); }

  std::filesystem::path file_;
  std::filesystem::path target_, part_;  // links resolved; both empty where the file is written directly
  std::ofstream stream_;
  std::ostream* standard_ = nullptr;  // instead of stream_, where the file is standard output or error
};

/// Replaces the file's content. Throws InputError, and leaves the old content, if it cannot be written.
void write_file(const std::filesystem::path& file, std::string_view content);

/// Throws InputError if StagedFile could not replace the file now. Its content stays, and so does a pipe.
void require_writable(const std::filesystem::path& file);

}  // namespace weft::engine
