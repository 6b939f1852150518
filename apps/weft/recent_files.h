#pragma once
/// The files that the window has shown, in the user's state folder ($XDG_STATE_HOME/weft/recent).

#include <filesystem>
#include <string>
#include <vector>

namespace weft::engine::app {

/// Newest first; without those that are gone. Empty without a state folder.
std::vector<std::string> read_recent_files();

/// Puts a file first. A state folder that cannot be written is no error: the list is then lost.
void remember_file(const std::filesystem::path& file);

}  // namespace weft::engine::app
