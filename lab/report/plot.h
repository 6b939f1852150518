#pragma once
/// Plots as SVG: points and lines, in panels with common axes.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace weft::engine::lab {

struct PlotPoint {
  double x = 1, y = 1;  // > 0 on logarithmic axes
  std::string label;    // tooltip, if the SVG is opened as a document
};

struct PlotSeries {
  std::string name;               // the same name has the same colour in all panels
  std::vector<PlotPoint> points;  // by ascending x
};

struct PlotPanel {
  std::string title;
  std::vector<PlotSeries> series;
};

enum class PlotScale { logarithmic, linear };

enum class PlotLine {
  along_best,   // joins the Pareto frontier: points lower than all on their left
  through_all,  // joins all points
};

struct Plot {
  std::string x_title, y_title;
  std::optional<double> mark_y;  // a dashed line across all panels
  std::vector<PlotPanel> panels;
  PlotScale x_scale = PlotScale::logarithmic, y_scale = PlotScale::logarithmic;
  PlotLine line = PlotLine::along_best;
};

/// Rows of two panels.
std::string to_svg(const Plot& plot);

/// Throws InputError if the file cannot be written.
void write_svg(const Plot& plot, const std::filesystem::path& file);

/// The slope of the least-squares line through the points (log x, log y).
double fit_exponent(const std::vector<PlotPoint>& points);

}  // namespace weft::engine::lab
