#pragma once
/// Plots as SVG: points and lines, in panels with common axes.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace weft::engine::lab {

struct PlotPoint {
  double x = 1, y = 1;  // > 0 on logarithmic axes
  std::string label;    // shown by the pointer, where the picture is looked at by itself
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
  along_best,   // joins the points that none on the left of them beats (lower is better)
  through_all,  // joins all of them
};

struct Plot {
  std::string x_title, y_title;
  std::optional<double> mark_y;  // a dashed line across all panels
  std::vector<PlotPanel> panels;
  PlotScale x_scale = PlotScale::logarithmic, y_scale = PlotScale::logarithmic;
  PlotLine line = PlotLine::along_best;
};

/// Two panels side by side, as many rows as needed.
std::string to_svg(const Plot& plot);

/// Throws InputError if the file cannot be written.
void write_svg(const Plot& plot, const std::filesystem::path& file);

/// The slope of the straight line nearest to the points (log x, log y).
double fit_exponent(const std::vector<PlotPoint>& points);

}  // namespace weft::engine::lab
