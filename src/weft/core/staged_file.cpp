#include "weft/core/staged_file.h"

#include <cerrno>
#include <iostream>
#include <system_error>

#include "weft/error.h"

#ifndef _WIN32
#include <fcntl.h>
#include <unistd.h>
#endif

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file, const std::error_code& reason) {
  throw InputError(file.string() + " cannot be written: " + reason.message());
}

/// Error code of the last failed call.
std::error_code last_error() { return {errno != 0 ? errno : EIO, std::generic_category()}; }

/// Opening /dev/stdout a second time would overwrite earlier output to the same file.
std::ostream* find_standard_stream(const fs::path& file) {
  std::error_code not_there;
  if (fs::equivalent(file, "/dev/stdout", not_there)) return &std::cout;
  if (fs::equivalent(file, "/dev/stderr", not_there)) return &std::cerr;
  return nullptr;
}

bool is_pipe_or_device(const fs::path& file) {
  std::error_code not_there;
  return fs::is_other(file, not_there);
}

fs::path resolve_link(const fs::path& file) {
  std::error_code error;
  if (!fs::is_symlink(file, error)) return file;
  const fs::path target = fs::weakly_canonical(file, error);
  return error ? file : target;
}

void observe(FileEvent event, const fs::path& path) {
  if (file_observer) file_observer(event, path);
}

/// Flushes a file or folder to disk (fsync); `file` is the name in messages.
void sync_to_disk(const fs::path& file, const fs::path& part) {
#ifndef _WIN32
  const int descriptor = open(part.c_str(), O_RDONLY | O_CLOEXEC);
  const bool is_synced = descriptor >= 0 && fsync(descriptor) == 0;
  const std::error_code reason = last_error();
  if (descriptor >= 0) close(descriptor);
  if (!is_synced) fail(file, reason);
#else
  (void)file, (void)part;
#endif
}

}  // namespace

std::function<void(FileEvent, const fs::path&)> file_observer;

StagedFile::StagedFile(const fs::path& file) : file_(file), standard_(find_standard_stream(file)) {
  if (standard_) return;
  if (!is_pipe_or_device(file)) {
    target_ = resolve_link(file);
    part_ = target_.parent_path() / ("." + target_.filename().string() + ".partial");
  }
  open(std::ios::out);
}

StagedFile::StagedFile(const fs::path& file, const fs::path& part, std::uintmax_t kept)
    : file_(file), target_(resolve_link(file)), part_(part), keeps_part_(true) {
  if (kept > 0) {
    std::error_code error;
    if (fs::file_size(part, error) < kept && !error) throw InputError(part.string() + " is too short");
    if (!error) fs::resize_file(part, kept, error);
    if (error) fail(part, error);
  }
  open(kept > 0 ? std::ios::in | std::ios::out : std::ios::out);
  out().seekp(0, std::ios::end);
}

void StagedFile::open(std::ios::openmode mode) {
  errno = 0;
  stream_.open(is_direct() ? file_ : part_, std::ios::binary | mode);
  if (!stream_) fail(file_, last_error());
}

StagedFile::~StagedFile() {
  stream_.close();
  std::error_code ignored;
  if (!is_direct() && !keeps_part_) fs::remove(part_, ignored);
}

void StagedFile::flush() {
  observe(FileEvent::flush, part_);
  out().flush();
  if (!out()) fail(file_, last_error());
}

void StagedFile::sync() {
  flush();
  if (is_direct()) return;
  observe(FileEvent::sync, part_);
  sync_to_disk(file_, part_);
}

void StagedFile::finish() {
  sync();
  if (!standard_) stream_.close();
  if (!out()) fail(file_, last_error());
  if (is_direct()) return;
  std::error_code ignored;
  const fs::file_status old = fs::status(target_, ignored);
  if (fs::is_regular_file(old)) fs::permissions(part_, old.permissions(), ignored);
}

void StagedFile::replace() {
  if (is_direct()) return;
  observe(FileEvent::rename, target_);
  std::error_code error;
  fs::rename(part_, target_, error);
  if (error) fail(file_, error);
  part_.clear();
}

void write_file(const fs::path& file, std::string_view content) {
  StagedFile staged(file);
  staged.out() << content;
  staged.finish();
  staged.replace();
}

void sync_file(const fs::path& file) {
  observe(FileEvent::sync, file);
  sync_to_disk(file, file);
}

void sync_folder(const fs::path& folder) {
  observe(FileEvent::sync_folder, folder);
  sync_to_disk(folder, folder.empty() ? "." : folder);
}

void require_writable(const fs::path& file) {
  if (is_pipe_or_device(file) || find_standard_stream(file)) return;
  std::error_code not_there;
  errno = 0;
  if (fs::exists(file, not_there) && !std::ofstream(file, std::ios::app)) fail(file, last_error());
  StagedFile probe(file);
}

}  // namespace weft::engine
