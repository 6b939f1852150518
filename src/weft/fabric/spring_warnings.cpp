#include "weft/fabric/spring_warnings.h"

#include <charconv>

namespace weft::engine {

std::string short_text(double number) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, number, std::chars_format::general, 4).ptr};
}

std::vector<std::string> warn_of_springs(const Fabric& fabric, const std::string& name) {
  std::vector<std::string> warnings;
  if (!fabric.stretch_warp.empty() || !fabric.stretch_weft.empty())
    warnings.push_back("fabric \"" + name +
                       "\": springs ignore its stretch curves; use membrane = \"triangle\"");
  if (fabric.c12 != fabric.g)
    warnings.push_back("fabric \"" + name + "\": springs impose c12 = g: c12 is " + short_text(fabric.g) +
                       " N/m instead of " + short_text(fabric.c12) +
                       " N/m (membrane = \"triangle\" preserves it)");
  return warnings;
}

}  // namespace weft::engine
