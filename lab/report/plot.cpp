#include "lab/report/plot.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "weft/error.h"

namespace weft::engine::lab {
namespace {

constexpr double kWidth = 400, kHeight = 300;  // of a panel's axes
constexpr double kLeft = 60, kTop = 40, kPitchX = kWidth + 90, kPitchY = kHeight + 95;
constexpr double kLegendPitch = 20;
constexpr std::size_t kMaxDots = 40;  // longer series have no dots
constexpr const char* kColours[] = {"#c0392b", "#2060b0", "#2e8b57", "#8e44ad",
                                    "#d08000", "#555555", "#10a0a0", "#a06040"};

std::string escape(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
  return safe;
}

/// The range of all values of all panels, so that panels can be compared.
class Axis {
 public:
  template <class Value>
  Axis(const Plot& plot, PlotScale scale, const Value& value) : scale_(scale) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const PlotPanel& panel : plot.panels) {
      for (const PlotSeries& series : panel.series) {
        for (const PlotPoint& p : series.points) {
          low = std::min(low, along(value(p)));
          high = std::max(high, along(value(p)));
        }
      }
    }
    if (!(low < high)) high = (low = std::isfinite(low) ? low - 0.5 : 0) + 1;
    pitch_ = scale == PlotScale::logarithmic ? 1 : round_pitch((high - low) / 6);
    low_ = pitch_ * std::floor(low / pitch_);
    high_ = pitch_ * std::ceil(high / pitch_);
  }

  /// Position along the axis, 0 to 1.
  double place(double value) const { return (along(value) - low_) / (high_ - low_); }

  /// Values with a grid line and a number.
  std::vector<double> ticks() const {
    std::vector<double> ticks;
    const int n = static_cast<int>(std::lround((high_ - low_) / pitch_));
    for (int i = 0; i <= n; ++i) {
      const double at = low_ + i * pitch_;
      ticks.push_back(scale_ == PlotScale::logarithmic ? std::pow(10, at) : at);
    }
    return ticks;
  }

 private:
  double along(double value) const { return scale_ == PlotScale::logarithmic ? std::log10(value) : value; }

  /// 1, 2 or 5 times a power of ten, at least `least`.
  static double round_pitch(double least) {
    const double power = std::pow(10, std::floor(std::log10(least)));
    for (const double digit : {1.0, 2.0, 5.0}) {
      if (digit * power >= least) return digit * power;
    }
    return 10 * power;
  }

  PlotScale scale_;
  double low_ = 0, high_ = 1, pitch_ = 1;  // on logarithmic axes, of exponents
};

class SvgWriter {
 public:
  explicit SvgWriter(const Plot& plot)
      : plot_(plot),
        x_(plot, plot.x_scale, [](const PlotPoint& p) { return p.x; }),
        y_(plot, plot.y_scale, [](const PlotPoint& p) { return p.y; }) {
    for (const PlotPanel& panel : plot.panels) {
      for (const PlotSeries& s : panel.series) {
        if (std::find(names_.begin(), names_.end(), s.name) == names_.end()) names_.push_back(s.name);
      }
    }
  }

  std::string write() {
    const std::size_t num_columns = std::min<std::size_t>(2, plot_.panels.size());
    const auto num_rows = (plot_.panels.size() + 1) / 2;
    const double width = kLeft + static_cast<double>(num_columns) * kPitchX;
    const double panels_height = kTop + kPitchY * static_cast<double>(num_rows);
    const std::vector<LegendPlace> legend = place_legend(width);
    const double height = panels_height + kLegendPitch * (legend.empty() ? 0 : legend.back().row + 1);
    text_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0f} {:.0f}\" font-family=\"sans-serif\" "
        "font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        width, height);
    for (std::size_t i = 0; i < plot_.panels.size(); ++i) {
      text_ += fmt::format("<g transform=\"translate({:.0f} {:.0f})\">\n",
                           kLeft + kPitchX * static_cast<double>(i % 2),
                           kTop + kPitchY * static_cast<double>(i / 2));
      write_panel(plot_.panels[i]);
      text_ += "</g>\n";
    }
    write_legend(legend, panels_height);
    return text_ + "</svg>\n";
  }

 private:
  const char* colour(const std::string& name) const {
    const auto i = std::find(names_.begin(), names_.end(), name) - names_.begin();
    return kColours[static_cast<std::size_t>(i) % std::size(kColours)];
  }

  double px(double x) const { return kWidth * x_.place(x); }
  double py(double y) const { return kHeight * (1 - y_.place(y)); }

  void line(double x0, double y0, double x1, double y1, const char* style) {
    text_ += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", x0, y0, x1,
                         y1, style);
  }

  void words(double x, double y, const std::string& text, const char* style) {
    text_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", x, y, style, escape(text));
  }

  void write_panel(const PlotPanel& panel) {
    words(kWidth / 2, -12, panel.title, "text-anchor=\"middle\" font-size=\"14\"");
    for (const double x : x_.ticks()) {
      line(px(x), 0, px(x), kHeight, "stroke=\"#ddd\"");
      words(px(x), kHeight + 16, fmt::format("{:.6g}", x), "text-anchor=\"middle\"");
    }
    for (const double y : y_.ticks()) {
      line(0, py(y), kWidth, py(y), "stroke=\"#ddd\"");
      words(-6, py(y) + 4, fmt::format("{:.6g}", y), "text-anchor=\"end\"");
    }
    if (plot_.mark_y)
      line(0, py(*plot_.mark_y), kWidth, py(*plot_.mark_y), "stroke=\"#888\" stroke-dasharray=\"5 4\"");
    words(kWidth / 2, kHeight + 36, plot_.x_title, "text-anchor=\"middle\"");
    const double middle = kHeight / 2;
    words(-42, middle, plot_.y_title,
          fmt::format("text-anchor=\"middle\" transform=\"rotate(-90 -42 {})\"", middle).c_str());
    for (const PlotSeries& series : panel.series) write_series(series);
  }

  void write_series(const PlotSeries& series) {
    std::string points;
    double lowest = std::numeric_limits<double>::infinity();
    for (const PlotPoint& p : series.points) {
      if (plot_.line == PlotLine::through_all || p.y < lowest)
        points += fmt::format("{:.1f},{:.1f} ", px(p.x), py(p.y));
      lowest = std::min(lowest, p.y);
    }
    text_ += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"/>\n",
                         points, colour(series.name));
    if (series.points.size() > kMaxDots) return;
    for (const PlotPoint& p : series.points) {
      text_ += fmt::format(
          "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" fill=\"{}\"><title>{}</title></circle>\n", px(p.x),
          py(p.y), colour(series.name), escape(p.label));
    }
  }

  /// Position of a name of the legend; rows break at the width of the plot.
  struct LegendPlace {
    double x;
    int row;
  };
  std::vector<LegendPlace> place_legend(double width) const {
    std::vector<LegendPlace> places;
    double x = kLeft;
    int row = 0;
    for (const std::string& name : names_) {
      const double length = 40 + 7.0 * static_cast<double>(name.size());
      if (x + length > width && x > kLeft) {
        x = kLeft;
        ++row;
      }
      places.push_back({x, row});
      x += length;
    }
    return places;
  }

  void write_legend(const std::vector<LegendPlace>& places, double top) {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const double x = places[i].x, y = top + kLegendPitch * places[i].row;
      text_ += fmt::format("<circle cx=\"{:.0f}\" cy=\"{:.0f}\" r=\"5\" fill=\"{}\"/>\n", x, y - 4,
                           colour(names_[i]));
      words(x + 10, y, names_[i], "");
    }
  }

  const Plot& plot_;
  Axis x_, y_;
  std::vector<std::string> names_;
  std::string text_;
};

}  // namespace

std::string to_svg(const Plot& plot) { return SvgWriter(plot).write(); }

void write_svg(const Plot& plot, const std::filesystem::path& file) {
  std::ofstream out(file, std::ios::binary);
  out << to_svg(plot);
  out.close();
  if (!out) throw InputError("cannot write " + file.string());
}

double fit_exponent(const std::vector<PlotPoint>& points) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const auto n = static_cast<double>(points.size());
  for (const PlotPoint& p : points) {
    const double a = std::log(p.x), b = std::log(p.y);
    sx += a, sy += b, sxx += a * a, sxy += a * b;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

}  // namespace weft::engine::lab
