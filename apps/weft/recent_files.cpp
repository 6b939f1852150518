#include "recent_files.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <system_error>

#include "weft/core/staged_file.h"
#include "weft/error.h"

namespace weft::engine::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMost = 8;

/// Empty if the user has none.
fs::path list_file() {
  if (const char* state = std::getenv("XDG_STATE_HOME"); state && *state)
    return fs::path(state) / "weft/recent";
  if (const char* home = std::getenv("HOME"); home && *home)
    return fs::path(home) / ".local/state/weft/recent";
  return {};
}

}  // namespace

std::vector<std::string> read_recent_files() {
  std::vector<std::string> files;
  std::ifstream in(list_file());
  std::error_code unreadable;
  for (std::string line; std::getline(in, line) && files.size() < kMost;) {
    if (fs::exists(line, unreadable)) files.push_back(line);
  }
  return files;
}

void remember_file(const fs::path& file) {
  const fs::path list = list_file();
  if (list.empty()) return;
  std::vector<std::string> files = read_recent_files();
  const std::string name = fs::absolute(file).lexically_normal().string();
  std::erase(files, name);
  files.insert(files.begin(), name);
  files.resize(std::min(files.size(), kMost));
  std::string text;
  for (const std::string& f : files) text += f + '\n';
  std::error_code failed;
  fs::create_directories(list.parent_path(), failed);
  try {
    write_file(list, text);
  } catch (const InputError&) {
  }
}

}  // namespace weft::engine::app
