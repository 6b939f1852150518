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

}  // namespace weft::engine
