/// Scene files: for any bytes, parse_scene returns a scene or throws SceneError.
/// Lines "# set: path.to.key=value" are overrides, as in tests/scene/broken.

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "weft/scene/scene_reader.h"

namespace {

weft::engine::Overrides find_overrides(std::string_view text) {
  constexpr std::string_view kMark = "# set: ";
  weft::engine::Overrides overrides;
  for (std::size_t at = text.find(kMark); at != text.npos; at = text.find(kMark, at + 1)) {
    const std::string_view line = text.substr(at, text.find('\n', at) - at);
    overrides.emplace_back(line.substr(kMark.size()));
  }
  return overrides;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    weft::engine::parse_scene(text, "fuzz.toml", find_overrides(text));
  } catch (const weft::SceneError&) {
  }
  return 0;
}
