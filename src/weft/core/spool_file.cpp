#include "weft/core/spool_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <string>
#include <system_error>

#include "weft/error.h"

#ifndef _WIN32
#include <unistd.h>
#include <cstdlib>
#endif

namespace weft::engine {
namespace {

[[noreturn]] void fail(const std::filesystem::path& target) {
  const int reason = errno != 0 ? errno : EIO;
  throw InputError(target.string() + " cannot be written: " + std::generic_category().message(reason));
}

/// nullptr where the folder does not allow it.
std::FILE* open_in(const std::filesystem::path& folder) {
#ifndef _WIN32
  std::string name = (folder / ".weft-XXXXXX").string();
  const int descriptor = mkstemp(name.data());
  if (descriptor < 0) return nullptr;
  unlink(name.c_str());
  return fdopen(descriptor, "w+b");
#else
  (void)folder;
  return std::tmpfile();
#endif
}

}  // namespace

SpoolFile::SpoolFile(const std::filesystem::path& target) : target_(target) {
  errno = 0;
  const std::filesystem::path folder = target.parent_path();
  file_.reset(open_in(folder.empty() ? "." : folder));
  if (!file_) file_.reset(open_in(std::filesystem::temp_directory_path()));
  if (!file_) fail(target_);
}

void SpoolFile::append(const void* bytes, std::size_t count) {
  if (count == 0) return;
  if (!is_at_end_) seek(size_);
  is_at_end_ = true;
  errno = 0;
  if (std::fwrite(bytes, 1, count, file_.get()) != count) fail(target_);
  size_ += count;
}

void SpoolFile::seek(std::size_t position) {
  errno = 0;
#ifdef _WIN32
  const int status = _fseeki64(file_.get(), static_cast<long long>(position), SEEK_SET);
#else
  const int status = fseeko(file_.get(), static_cast<off_t>(position), SEEK_SET);
#endif
  if (status != 0) fail(target_);
}

void SpoolFile::read(std::size_t position, void* bytes, std::size_t count) {
  seek(position);
  is_at_end_ = false;
  if (std::fread(bytes, 1, count, file_.get()) != count) fail(target_);
}

void SpoolFile::copy_to(std::ostream& out) {
  seek(0);
  is_at_end_ = false;
  std::array<char, 1 << 16> buffer;
  for (std::size_t left = size_; left > 0;) {
    const std::size_t count = std::fread(buffer.data(), 1, std::min(left, buffer.size()), file_.get());
    if (count == 0) fail(target_);
    out.write(buffer.data(), static_cast<std::streamsize>(count));
    left -= count;
  }
}

}  // namespace weft::engine
