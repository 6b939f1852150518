#pragma once
/// The controls over the picture.

namespace weft::engine::app {

class Viewer;

/// Colours and sizes of all controls; `scale` as Window::scale tells.
void set_panel_style(double scale);

/// Within a frame of the viewer's window.
void draw_panel(Viewer& viewer);

}  // namespace weft::engine::app
