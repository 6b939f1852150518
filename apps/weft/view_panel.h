#pragma once
/// Controls over the picture.

namespace weft::engine::app {

class Viewer;

/// Colours and sizes of all controls; `scale` from Window::scale.
void set_panel_style(double scale);

/// Call within a frame of the viewer's window.
void draw_panel(Viewer& viewer);

}  // namespace weft::engine::app
