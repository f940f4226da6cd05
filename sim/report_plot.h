// Rate-distortion plots as inline SVG: axes with units, legend, marks. Colors come from the page's style.
#pragma once

#include <string>
#include <vector>

namespace pac::sim {

struct PlotPoint {
  double x = 0, y = 0;
  std::string label;  // shown when pointed at
};

struct PlotSeries {
  std::string name;
  std::string style;              // CSS class: "image", "polygon", or "hue0" .. "hue6"
  std::vector<PlotPoint> points;  // x ascending
};

// A vertical line.
struct PlotMark {
  double x = 0;
  std::string label;
};

struct Plot {
  std::string id, title, description;  // description: for those who cannot see it
  std::string x_label = "bytes";
  std::string y_label;
  std::string top_label = "bits per pixel";
  double top_per_x = 0;  // top axis value = x * top_per_x; 0 = no top axis
  bool log_x = true;
  bool zero_line = false;  // a horizontal line at y = 0
  std::vector<PlotSeries> series;
  std::vector<PlotMark> marks;
};

// An <svg> element. Points that are not finite (or not positive on a logarithmic axis) are left out.
std::string plot_svg(const Plot& plot);

}  // namespace pac::sim
