#include "weft/core/file_name.h"

#include <cstdio>

#include <cctype>

namespace weft::engine {

std::string FileNames::add(std::string name) {
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_' && c != '.') c = '_';
  }
  std::string unique = name;
  for (int number = 2; !taken_.insert(unique).second; ++number) unique = name + '_' + std::to_string(number);
  return unique;
}

std::string frame_ending(int frame) {
  char text[16];
  std::snprintf(text, sizeof text, "_%04d", frame);
  return text;
}

}  // namespace weft::engine
