#pragma once
/// What is drawn over the picture: legends, the probe's readings, the wind's arrow, the selection's box.

namespace weft::engine::app {

class Viewer;

/// Call within a frame of the viewer's window, before the panels.
void draw_overlays(Viewer& viewer);

}  // namespace weft::engine::app
