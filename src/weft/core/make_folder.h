#pragma once
/// Creation of folders.

#include <filesystem>

namespace weft::engine {

/// Creates the folder, with those above it; it may exist. Throws InputError with the system's reason.
void make_folder(const std::filesystem::path& folder);

}  // namespace weft::engine
