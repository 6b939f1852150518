#pragma once
/// A program that drops a file on a window, as file managers do: the source of the X Drag-and-Drop protocol,
/// version 5 (freedesktop.org).

#include <string>

namespace weft::engine {

/// Drops a file, by its absolute path, at a position on the screen of DISPLAY [pixels]. False: no window there
/// accepts files, or it has not finished within 30 s.
bool drop_file(const std::string& file, int x, int y);

}  // namespace weft::engine
