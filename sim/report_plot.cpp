#include "sim/report_plot.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>

#include "base/exact_math.h"
#include "sim/report_markup.h"

namespace pac::sim {
namespace {

// The drawing's own units; the page scales it.
constexpr double kWidth = 520;
constexpr double kLeft = 58, kRight = 504, kTop = 44, kBottom = 318;

std::string text_of(double number, int digits) {
  char buffer[64];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, number, std::chars_format::fixed, digits).ptr;
  return std::string(buffer, end);
}

double log_of(double x) {
  return exact_log(x);
}

// A linear or logarithmic scale from data to drawing units.
struct Axis {
  double low = 0, high = 1;  // data
  double from = 0, to = 1;   // drawing
  bool logarithmic = false;

  double place(double value) const {
    const double part =
        logarithmic ? (log_of(value) - log_of(low)) / (log_of(high) - log_of(low)) : (value - low) / (high - low);
    return from + part * (to - from);
  }
};

struct Tick {
  double value;
  bool labelled;
};

// 1, 2, 5 times powers of ten inside the axis; all digits, unlabelled, where there is room.
std::vector<Tick> log_ticks(const Axis& axis) {
  std::vector<Tick> ticks;
  for (double decade = 1e-6; decade < 1e12; decade *= 10)
    for (int digit = 1; digit < 10; ++digit) {
      const double value = digit * decade;
      if (value >= axis.low * 0.9999 && value <= axis.high * 1.0001)
        ticks.push_back({value, digit == 1 || digit == 2 || digit == 5});
    }
  return ticks;
}

// About `count` multiples of 1, 2 or 5 times a power of ten.
double linear_step(double span, int count) {
  double step = 1e-9;
  while (step * 10 * count < span) step *= 10;
  for (const double factor : {1.0, 2.0, 5.0, 10.0})
    if (step * factor * count >= span) return step * factor;
  return step * 10;
}

std::vector<Tick> linear_ticks(const Axis& axis, int count) {
  std::vector<Tick> ticks;
  const double step = linear_step(axis.high - axis.low, count);
  for (double index = std::ceil(axis.low / step - 1e-6); index * step <= axis.high + step * 1e-6; index += 1)
    ticks.push_back({index * step, true});
  return ticks;
}

std::string tick_text(double value) {
  const double size = std::fabs(value);
  if (size >= 10000) return text_of(value / 1000, 0) + "k";
  if (size >= 1000) return text_of(value / 1000, std::fmod(value, 1000) == 0 ? 0 : 1) + "k";
  std::string text = text_of(value, size >= 10 ? 1 : 3);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

bool is_drawable(const Plot& plot, const PlotPoint& point) {
  return std::isfinite(point.x) && std::isfinite(point.y) && (!plot.log_x || point.x > 0);
}

void fit_axes(const Plot& plot, Axis& x, Axis& y) {
  bool first = true;
  const auto include = [&](double px, double py) {
    x.low = first ? px : std::min(x.low, px);
    x.high = first ? px : std::max(x.high, px);
    y.low = first ? py : std::min(y.low, py);
    y.high = first ? py : std::max(y.high, py);
    first = false;
  };
  for (const PlotSeries& series : plot.series)
    for (const PlotPoint& point : series.points)
      if (is_drawable(plot, point)) include(point.x, point.y);
  if (first) include(1, 0);
  if (plot.zero_line) include(x.low, 0);
  x.logarithmic = plot.log_x;
  if (plot.log_x) {
    x.low *= 0.9;
    x.high *= 1.1;
  } else if (x.low == x.high) {
    x.high = x.low + 1;
  }
  const double margin = y.high > y.low ? 0.05 * (y.high - y.low) : 0.5;
  y.low -= margin;
  y.high += margin;
}

std::string line(double x1, double y1, double x2, double y2, const char* style) {
  return std::string("<line class=\"") + style + "\" x1=\"" + text_of(x1, 1) + "\" y1=\"" + text_of(y1, 1) +
         "\" x2=\"" + text_of(x2, 1) + "\" y2=\"" + text_of(y2, 1) + "\"/>";
}

std::string label(double x, double y, const char* style, const std::string& text, const char* attributes = "") {
  return std::string("<text class=\"") + style + "\" x=\"" + text_of(x, 1) + "\" y=\"" + text_of(y, 1) + "\"" +
         attributes + ">" + html_escaped(text) + "</text>";
}

// Labels closer than this to the one before are left out.
constexpr double kLabelDistance = 26;

std::string x_axis(const Plot& plot, const Axis& x) {
  std::string svg;
  double last = -1e9;
  for (const Tick& tick : plot.log_x ? log_ticks(x) : linear_ticks(x, 6)) {
    const double at = x.place(tick.value);
    svg += line(at, kTop, at, kBottom, tick.labelled ? "grid" : "grid faint");
    if (!tick.labelled || at - last < kLabelDistance) continue;
    svg += label(at, kBottom + 17, "tick middle", tick_text(tick.value));
    last = at;
  }
  svg += label((kLeft + kRight) / 2, kBottom + 36, "axis middle", plot.x_label);
  return svg;
}

std::string top_axis(const Plot& plot, const Axis& x) {
  if (plot.top_per_x <= 0) return "";
  Axis top = x;
  top.low *= plot.top_per_x;
  top.high *= plot.top_per_x;
  std::string svg;
  double last = -1e9;
  for (const Tick& tick : plot.log_x ? log_ticks(top) : linear_ticks(top, 6)) {
    const double at = top.place(tick.value);
    svg += line(at, kTop - 4, at, kTop, "frame");
    if (!tick.labelled || at - last < kLabelDistance) continue;
    svg += label(at, kTop - 8, "tick middle", tick_text(tick.value));
    last = at;
  }
  return svg + label(kRight, kTop - 27, "tick end", plot.top_label);
}

std::string y_axis(const Plot& plot, const Axis& y) {
  std::string svg;
  for (const Tick& tick : linear_ticks(y, 6)) {
    const double at = y.place(tick.value);
    svg += line(kLeft, at, kRight, at, "grid");
    svg += label(kLeft - 7, at + 4, "tick end", tick_text(tick.value));
  }
  if (plot.zero_line) svg += line(kLeft, y.place(0), kRight, y.place(0), "zero");
  return svg + label(kLeft - 44, kTop - 27, "axis", plot.y_label);
}

std::string draw_marks(const Plot& plot, const Axis& x) {
  std::string svg;
  double row = plot.zero_line ? kTop + 14 : kBottom - 8;
  for (const PlotMark& mark : plot.marks) {
    if (!(mark.x > x.low && mark.x < x.high)) continue;
    const double at = x.place(mark.x);
    const bool left_of_it = at > (kLeft + kRight) / 2;
    svg += line(at, kTop, at, kBottom, "mark");
    svg += label(at + (left_of_it ? -5 : 5), row, left_of_it ? "note end" : "note", mark.label);
    row -= 15;
  }
  return svg;
}

// A shape a series, so that color is not needed to tell neighbors apart: square, circle, triangle, diamond.
std::string marker(double x, double y, size_t series_index) {
  const auto polygon = [&](std::initializer_list<double> offsets) {
    std::string points;
    bool is_x = true;
    for (const double offset : offsets) {
      points += text_of((is_x ? x : y) + offset, 1);
      points += is_x ? "," : " ";
      is_x = !is_x;
    }
    return "<polygon points=\"" + points + "\"/>";
  };
  switch (series_index % 4) {
    case 0:
      return polygon({-3.2, -3.2, 3.2, -3.2, 3.2, 3.2, -3.2, 3.2});
    case 1: {
      std::string circle = "<circle cx=\"";
      return circle + text_of(x, 1) + "\" cy=\"" + text_of(y, 1) + "\" r=\"3.7\"/>";
    }
    case 2:
      return polygon({0, -4.4, 4.2, 3.4, -4.2, 3.4});
    default:
      return polygon({0, -4.6, 4.6, 0, 0, 4.6, -4.6, 0});
  }
}

std::string draw_series(const Plot& plot, const Axis& x, const Axis& y) {
  std::string svg;
  for (size_t i = 0; i < plot.series.size(); ++i) {
    const PlotSeries& series = plot.series[i];
    std::string path, markers;
    for (const PlotPoint& point : series.points) {
      if (!is_drawable(plot, point)) continue;
      const double px = x.place(point.x), py = y.place(point.y);
      path += path.empty() ? "M" : "L";
      path += text_of(px, 1) + " " + text_of(py, 1);
      markers += std::string("<g class=\"point\">") + marker(px, py, i) + "<title>" + html_escaped(point.label) +
                 "</title></g>";
    }
    if (path.empty()) continue;
    svg += "<g class=\"series " + series.style + "\"><path d=\"" + path + "\"/>" + markers + "</g>";
  }
  return svg;
}

constexpr double kLegendTop = kBottom + 58, kLegendRow = 19;

// Where each series' entry stands: left to right, in as many rows as they need.
struct LegendPlace {
  double x, y;
};
std::vector<LegendPlace> legend_places(const Plot& plot) {
  std::vector<LegendPlace> places;
  double x = kLeft, y = kLegendTop;
  for (const PlotSeries& series : plot.series) {
    const double width = 46 + 6.4 * static_cast<double>(series.name.size());
    if (x > kLeft && x + width > kRight + 12) {
      x = kLeft;
      y += kLegendRow;
    }
    places.push_back({x, y});
    x += width;
  }
  return places;
}

std::string legend(const Plot& plot) {
  std::string svg;
  const std::vector<LegendPlace> places = legend_places(plot);
  for (size_t i = 0; i < plot.series.size(); ++i) {
    const PlotSeries& series = plot.series[i];
    const auto [x, y] = places[i];
    svg += "<g class=\"series " + series.style + "\"><path d=\"M" + text_of(x, 1) + " " + text_of(y, 1) + "h22\"/>";
    svg += marker(x + 11, y, i) + "</g>" + label(x + 28, y + 4, "tick", series.name);
  }
  return svg;
}

}  // namespace

std::string plot_svg(const Plot& plot) {
  Axis x{.from = kLeft, .to = kRight}, y{.from = kBottom, .to = kTop};
  fit_axes(plot, x, y);
  const double height = 12 + (plot.series.empty() ? kLegendTop : legend_places(plot).back().y);
  std::string svg = std::string("<svg class=\"plot\" viewBox=\"0 0 ") + text_of(kWidth, 0) + " " + text_of(height, 0) +
                    "\" role=\"img\" aria-labelledby=\"" + plot.id + "-t " + plot.id + "-d\"><title id=\"" + plot.id +
                    "-t\">" + html_escaped(plot.title) + "</title><desc id=\"" + plot.id + "-d\">" +
                    html_escaped(plot.description) + "</desc>";
  svg += x_axis(plot, x) + top_axis(plot, x) + y_axis(plot, y);
  svg += std::string("<rect class=\"frame\" x=\"") + text_of(kLeft, 1) + "\" y=\"" + text_of(kTop, 1) + "\" width=\"" +
         text_of(kRight - kLeft, 1) + "\" height=\"" + text_of(kBottom - kTop, 1) + "\"/>";
  svg += draw_marks(plot, x) + draw_series(plot, x, y) + legend(plot);
  return svg + "</svg>\n";
}

}  // namespace pac::sim
