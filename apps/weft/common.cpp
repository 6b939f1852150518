#include "common.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <system_error>
#include <thread>

#include "weft/core/error.h"

namespace weft::app {

namespace fs = std::filesystem;

void require_writable(const fs::path& file) {
  std::error_code error;
  if (fs::is_other(file, error)) return;
  const bool is_new = !fs::exists(fs::symlink_status(file, error));
  errno = 0;
  if (!std::ofstream(file, std::ios::app)) {
    throw InputError(file.string() + " cannot be written: " + std::generic_category().message(errno));
  }
  if (is_new) fs::remove(file, error);
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError("the folder " + folder.string() + " cannot be made: " + error.message());
}

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  if (!out.flush()) throw InputError(file.string() + ": cannot be written");
}

int num_processors() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

void add_set_option(CLI::App& command, Overrides& overrides) {
  command.add_option("--set", overrides, "Change a value, as in --set solver.integrator=desbrun")
      ->type_name("KEY=VALUE")
      ->take_all()
      ->allow_extra_args(false);
}

PictureSize parse_size(const std::string& text) {
  PictureSize size;
  char end = 0;
  constexpr int kLargest = 16384;
  const bool is_good = std::sscanf(text.c_str(), "%dx%d%c", &size.width, &size.height, &end) == 2 &&
                       size.width > 0 && size.height > 0 && size.width <= kLargest && size.height <= kLargest;
  if (!is_good) throw InputError("--size " + text + ": expected WIDTHxHEIGHT in pixels, such as 1280x720");
  return size;
}

}  // namespace weft::app
