#pragma once
/// Atomic replacement of files.

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
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

  /// Writes to `part` instead, which stays if replace() is not called, also when the program is killed. Its
  /// first `kept` bytes are kept, and the rest is appended; it must have them.
  StagedFile(const std::filesystem::path& file, const std::filesystem::path& part, std::uintmax_t kept = 0);

  /// Removes `.NAME.partial` if replace() was not called.
  ~StagedFile();

  StagedFile(const StagedFile&) = delete;
  StagedFile& operator=(const StagedFile&) = delete;

  const std::filesystem::path& file() const { return file_; }
  std::ostream& out() { return standard_ ? *standard_ : stream_; }

  /// Passes everything written so far to the system: readers of the partial file have it.
  void flush();

  /// The same, and to the disk (fsync): it survives a power failure.
  void sync();

  /// Completes the new content, on the disk. Call once, before replace().
  void finish();

  /// Renames the new content over the old; symbolic links and the old file's permissions are kept.
  void replace();

 private:
  bool is_direct() const { return part_.empty(); }
  void open(std::ios::openmode mode);

  std::filesystem::path file_;
  std::filesystem::path target_, part_;  // links resolved; both empty for directly written files
  bool keeps_part_ = false;
  std::ofstream stream_;
  std::ostream* standard_ = nullptr;  // replaces stream_ for standard output and error
};

/// Replaces the file's content. Throws InputError, and keeps the old content, if it cannot be written.
void write_file(const std::filesystem::path& file, std::string_view content);

/// Throws InputError if StagedFile could not replace the file now. Does not change a file or pipe.
void require_writable(const std::filesystem::path& file);

/// Passes a file's content to the disk (fsync). Throws InputError if that fails.
void sync_file(const std::filesystem::path& file);

/// Passes the names of a folder's files to the disk (fsync), so that a rename survives a power failure.
void sync_folder(const std::filesystem::path& folder);

enum class FileEvent { flush, sync, rename, sync_folder };

/// For tests: called before every such operation of this process; by default nothing.
extern std::function<void(FileEvent, const std::filesystem::path&)> file_observer;

}  // namespace weft::engine
