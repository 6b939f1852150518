#include "apps/common/command_line.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <thread>

#include "weft/error.h"

namespace weft::engine::app {

void say(const std::string& line) { std::fputs((line + "\n").c_str(), stderr); }

int num_processors() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

int choose_threads(int asked) {
  constexpr int kMaxPerProcessor = 4;  // above it, oneTBB ignores the excess and prints a warning
  const int most = kMaxPerProcessor * num_processors();
  if (asked > most) say(fmt::format("--threads {}: limited to {}, four per processor", asked, most));
  return asked > 0 ? std::min(asked, most) : num_processors();
}

void add_set_option(CLI::App& command, Overrides& overrides) {
  command.add_option("--set", overrides, "Change a value, as in --set solver.integrator=desbrun")
      ->type_name("KEY=VALUE")
      ->take_all()
      ->allow_extra_args(false);
}

PictureSize parse_size(const std::string& text) {
  PictureSize size;
  char end = 0;
  constexpr int kLargest = 16384;  // texture limit of most OpenGL drivers
  const bool is_good = std::sscanf(text.c_str(), "%dx%d%c", &size.width, &size.height, &end) == 2 &&
                       size.width > 0 && size.height > 0 && size.width <= kLargest && size.height <= kLargest;
  if (!is_good) {
    throw InputError(fmt::format(
        "--size {}: expected WIDTHxHEIGHT in pixels, such as 1280x720, each from 1 to {}", text, kLargest));
  }
  return size;
}

}  // namespace weft::engine::app
