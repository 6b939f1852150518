#include "weft/io/input_file.h"

#include <cerrno>
#include <sstream>
#include <system_error>

#include "weft/error.h"

namespace weft::engine {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file) {
  throw InputError(file.string() +
                   ": cannot be read: " + std::generic_category().message(errno != 0 ? errno : EIO));
}

}  // namespace

std::ifstream open_input(const std::filesystem::path& file, std::string_view kind) {
  std::error_code not_there;
  if (std::filesystem::is_directory(file, not_there))
    throw InputError(file.string() + ": this is a folder; expected " + std::string(kind));
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in) fail(file);
  return in;
}

std::string read_bytes(const std::filesystem::path& file, std::string_view kind) {
  std::ifstream in = open_input(file, kind);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  if (in.bad() || bytes.bad()) fail(file);
  return std::move(bytes).str();
}

}  // namespace weft::engine
