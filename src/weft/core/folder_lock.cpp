#include "weft/core/folder_lock.h"

#include <cerrno>
#include <system_error>

#include "weft/core/make_folder.h"
#include "weft/error.h"

#ifndef _WIN32
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

namespace weft::engine {

#ifndef _WIN32

FolderLock::FolderLock(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "lock";
  for (;;) {
    make_folder(folder);
    descriptor_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor_ < 0)
      throw InputError(file.string() + " cannot be written: " + std::generic_category().message(errno));
    if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      const int reason = errno;
      close(descriptor_);
      throw InputError(folder.string() +
                       (reason == EWOULDBLOCK
                            ? " is in use: another run writes into it"
                            : " cannot be locked: " + std::generic_category().message(reason)));
    }
    // Its holder may have removed the folder between open() and flock().
    struct stat held {
    }, there{};
    if (fstat(descriptor_, &held) == 0 && stat(file.c_str(), &there) == 0 && held.st_ino == there.st_ino &&
        held.st_dev == there.st_dev)
      return;
    close(descriptor_);
  }
}

FolderLock::~FolderLock() { close(descriptor_); }

#else

FolderLock::FolderLock(const std::filesystem::path& folder) { make_folder(folder); }
FolderLock::~FolderLock() = default;

#endif

}  // namespace weft::engine
