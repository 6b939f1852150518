#include "weft/core/make_folder.h"

#include <system_error>

#include "weft/error.h"

namespace weft::engine {

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError("cannot create folder " + folder.string() + ": " + error.message());
}

}  // namespace weft::engine
