#pragma once
/// Plots of the last steps: work by kind, strain, energy, contacts, iterations.

namespace weft::engine::app {

class Viewer;

/// At the lower right of the window. Call within a frame of the viewer's window.
void draw_plots(Viewer& viewer);

}  // namespace weft::engine::app
