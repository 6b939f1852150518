#pragma once
/// `weft bench contact`: accuracy and cost of contact.

#include <array>
#include <string>
#include <vector>

namespace weft::engine::lab {

/// In the order of their tables.
inline constexpr std::array kContactSections = {"memory", "scenes",   "overhead", "layers",
                                                "rest",   "friction", "momentum", "energy"};

struct ContactBenchOptions {
  std::vector<std::string> sections;  // of kContactSections; empty: all
  std::vector<std::string> scenes;    // empty: all shipped ones in contact/
  std::vector<int> threads = {1, 2};
  int frames = 0;      // of each scene; 0: all
  bool quick = false;  // the beginning of each scene, one thread, coarse sheets
};

/// Prints tables in Markdown to standard output. Returns false if cloth intersects anything in any frame.
bool bench_contact(const ContactBenchOptions& options);

}  // namespace weft::engine::lab
