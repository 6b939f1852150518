#pragma once
/// The panel of numbers: fabrics by name, and every tunable number of the scene, from the table of parameters.

namespace weft::engine::app {

class Viewer;

inline constexpr float kNumbersWidth = 308;  // [pixels]

/// At the right edge of the window. Call within a frame of the viewer's window.
void draw_tuning(Viewer& viewer);

}  // namespace weft::engine::app
