#pragma once
/// Points on logarithmic axes, as SVG; of each series a line joins those that none on the left of them beats.

#include <filesystem>
#include <string>
#include <vector>

namespace weft::bench {

struct PlotPoint {
  double x = 1, y = 1;  // > 0
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

struct Plot {
  std::string x_title, y_title;
  double mark_y = 0;  // a dashed line across all panels; 0: none
  std::vector<PlotPanel> panels;
};

/// Two panels side by side, as many rows as needed. Throws InputError if the file cannot be written.
void write_svg(const Plot& plot, const std::filesystem::path& file);

}  // namespace weft::bench
