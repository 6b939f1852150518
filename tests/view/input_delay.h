#pragma once
/// Time from input to the picture that shows it, measured from outside of the program.

#include <vector>

namespace weft::engine {

/// Moves the pointer of DISPLAY so many times, to and fro around a position, and waits each time until the
/// middle of the screen differs. Milliseconds of each; fewer if a picture has not changed within 10 s. The
/// caller holds the mouse button that turns the view.
std::vector<double> measure_input_delays(int times, int x, int y);

}  // namespace weft::engine
