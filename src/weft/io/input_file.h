#pragma once
/// Input files: opening and reading.

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace weft::engine {

/// Opens a file for reading its bytes. `kind` names the expected kind in messages, such as "an OBJ file".
/// Throws InputError, with the file's name and the reason, for folders and for files that cannot be read.
std::ifstream open_input(const std::filesystem::path& file, std::string_view kind);

/// All bytes of a file; errors as above.
std::string read_bytes(const std::filesystem::path& file, std::string_view kind);

}  // namespace weft::engine
