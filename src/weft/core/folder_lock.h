#pragma once
/// Exclusive use of a folder by one process.

#include <filesystem>

namespace weft::engine {

/// Holds the lock of a folder, a file `lock` in it, until this or the process ends, also by a signal.
class FolderLock {
 public:
  /// Throws InputError if another process, or another lock of this one, holds it, and if the file cannot be
  /// written.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();

  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace weft::engine
