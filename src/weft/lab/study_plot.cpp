#include <algorithm>
#include <cmath>

#include "weft/lab/study.h"

namespace weft {
namespace {

constexpr double kWidth = 480, kHeight = 320;  // of the axes
constexpr double kLeft = 70, kTop = 40, kRight = 190, kBottom = 60;
constexpr const char* kColours[] = {"#c0392b", "#2060b0", "#2e8b57", "#8e44ad", "#d08000", "#555555"};

/// A linear axis with marks at round numbers.
struct Axis {
  double low = 0, high = 1, pitch = 0.2;

  double share(double value) const { return (value - low) / (high - low); }
};

Axis make_axis(double low, double high) {
  const double span = high > low ? high - low : std::max(std::abs(high), 1.0);
  const double power = std::pow(10, std::floor(std::log10(span / 4)));
  const double times = span / 4 / power;
  const double pitch = power * (times > 5 ? 10 : times > 2 ? 5 : times > 1 ? 2 : 1);
  return {pitch * std::floor(low / pitch), pitch * std::ceil((low + span) / pitch), pitch};
}

std::string escape(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
  return safe;
}

class Drawing {
 public:
  explicit Drawing(const StudyPlot& plot) : plot_(plot) {
    double x_low = 1e300, x_high = -1e300, y_low = 1e300, y_high = -1e300;
    for (const auto* curves : {&plot.curves, &plot.measured_by_others}) {
      for (const Curve& curve : *curves) {
        for (const auto& [x, y] : curve.points) {
          x_low = std::min(x_low, x), x_high = std::max(x_high, x);
          y_low = std::min(y_low, y), y_high = std::max(y_high, y);
        }
      }
    }
    if (x_low > x_high) x_low = y_low = 0, x_high = y_high = 1;
    x_ = make_axis(x_low, x_high);
    y_ = make_axis(y_low, y_high);
  }

  std::string draw() {
    draw_axes();
    int number = 0;
    for (const Curve& curve : plot_.curves) draw_curve(curve, number++, true);
    for (const Curve& curve : plot_.measured_by_others) draw_curve(curve, number++, false);
    const std::string size = digits(kLeft + kWidth + kRight, 6) + " " + digits(kTop + kHeight + kBottom, 6);
    return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + size +
           "\" font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" "
           "fill=\"white\"/>\n" +
           body_ + "</svg>\n";
  }

 private:
  std::string px(double x) const { return digits(kLeft + kWidth * x_.share(x), 6); }
  std::string py(double y) const { return digits(kTop + kHeight * (1 - y_.share(y)), 6); }

  void line(const std::string& x1, const std::string& y1, const std::string& x2, const std::string& y2) {
    body_ += "<path d=\"M" + x1 + " " + y1 + "L" + x2 + " " + y2 + "\" stroke=\"#ddd\"/>\n";
  }

  void text(double x, double y, const char* anchor, const std::string& words, const char* more = "") {
    body_ += "<text x=\"" + digits(x, 6) + "\" y=\"" + digits(y, 6) + "\" text-anchor=\"" + anchor + "\"" +
             more + ">" + escape(words) + "</text>\n";
  }

  void draw_axes() {
    for (double x = x_.low; x < x_.high + x_.pitch / 2; x += x_.pitch) {
      line(px(x), py(y_.low), px(x), py(y_.high));
      text(kLeft + kWidth * x_.share(x), kTop + kHeight + 18, "middle", digits(round_off(x, x_), 4));
    }
    for (double y = y_.low; y < y_.high + y_.pitch / 2; y += y_.pitch) {
      line(px(x_.low), py(y), px(x_.high), py(y));
      text(kLeft - 8, kTop + kHeight * (1 - y_.share(y)) + 4, "end", digits(round_off(y, y_), 4));
    }
    text(kLeft, 22, "start", plot_.title, " font-weight=\"bold\"");
    text(kLeft + kWidth / 2, kTop + kHeight + 44, "middle", plot_.x_title);
    text(0, 0, "middle", plot_.y_title,
         (" transform=\"translate(18 " + digits(kTop + kHeight / 2, 6) + ") rotate(-90)\"").c_str());
  }

  static double round_off(double value, const Axis& axis) {
    return std::abs(value) < 1e-9 * axis.pitch ? 0 : value;
  }

  void draw_curve(const Curve& curve, int number, bool has_line) {
    const std::string colour = kColours[number % std::size(kColours)];
    std::string path;
    for (const auto& [x, y] : curve.points) {
      path += (path.empty() ? "M" : "L") + px(x) + " " + py(y);
      body_ += "<circle cx=\"" + px(x) + "\" cy=\"" + py(y) + "\" r=\"3\" fill=\"" + colour + "\"/>\n";
    }
    if (has_line)
      body_ += "<path d=\"" + path + "\" fill=\"none\" stroke=\"" + colour + "\" stroke-width=\"1.5\"/>\n";
    const double y = kTop + 12 + 20 * number;
    body_ += "<circle cx=\"" + digits(kLeft + kWidth + 16, 6) + "\" cy=\"" + digits(y - 4, 6) +
             "\" r=\"4\" fill=\"" + colour + "\"/>\n";
    text(kLeft + kWidth + 26, y, "start", curve.name);
  }

  const StudyPlot& plot_;
  Axis x_, y_;
  std::string body_;
};

}  // namespace

std::string to_svg(const StudyPlot& plot) { return Drawing(plot).draw(); }

}  // namespace weft
