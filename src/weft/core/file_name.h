#pragma once
/// File names from names that people gave.

#include <set>
#include <string>

namespace weft::engine {

/// Gives each name a file name that no other has.
class FileNames {
 public:
  /// Letters, digits, '-', '_' and '.' are kept, other characters become '_'. A name that is taken gets a
  /// number: "sheet", "sheet_2".
  std::string add(std::string name);

 private:
  std::set<std::string> taken_;
};

/// The end of the name of a frame's file, before its ending: "_0012".
std::string frame_ending(int frame);

}  // namespace weft::engine
