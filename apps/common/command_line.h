#pragma once
/// Shared helpers of the commands.

#include <string>

#include "weft/render/camera.h"
#include "weft/scene/scene_reader.h"

namespace CLI {
class App;
}

namespace weft::engine::app {

/// Prints a line to standard error; a closed or full stream is not an error.
void say(const std::string& line);

/// Processors of this machine, at least 1.
int num_processors();

/// Number of threads for a requested one (0: one per processor): at most four per processor, with a note.
int choose_threads(int asked);

/// --set KEY=VALUE, repeatable.
void add_set_option(CLI::App& command, Overrides& overrides);

/// "1280x720" as a size, each from 1 to 16384; throws InputError for anything else.
PictureSize parse_size(const std::string& text);

}  // namespace weft::engine::app
