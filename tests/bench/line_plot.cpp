// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/line_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>

namespace souple::bench {
namespace {

constexpr double left = 70, right = 560, top = 40, bottom = 380, legend = 575;

constexpr std::array<const char*, 9> colours{"#1f5fa8", "#c0392b", "#2e8b57", "#8e44ad", "#d68910",
                                             "#17a2b8", "#7f5539", "#555555", "#000000"};

struct Axis {
  bool logarithmic = false;
  double low = std::numeric_limits<double>::infinity(), high = -low;  ///< decades, or the value
  double from = 0, to = 1;                                            ///< pixels

  bool shows(double value) const { return std::isfinite(value) && (!logarithmic || value > 0); }
  double scaled(double value) const { return logarithmic ? std::log10(value) : value; }
  void cover(double value) {
    low = std::min(low, scaled(value));
    high = std::max(high, scaled(value));
  }
  void finish() {
    if (!(low <= high)) low = 0, high = 1;
    if (logarithmic) low = std::floor(low), high = std::ceil(high);
    if (high <= low) high = low + 1;
  }
  double at(double value) const { return from + (scaled(value) - low) / (high - low) * (to - from); }
};

std::string number(const char* format, double value) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

std::string text(double x, double y, const std::string& what, const char* anchor) {
  return "<text x=\"" + number("%.1f", x) + "\" y=\"" + number("%.1f", y) + "\" text-anchor=\"" +
         anchor + "\">" + what + "</text>\n";
}

std::string line(double x1, double y1, double x2, double y2) {
  return "<line class=\"grid\" x1=\"" + number("%.1f", x1) + "\" y1=\"" + number("%.1f", y1) +
         "\" x2=\"" + number("%.1f", x2) + "\" y2=\"" + number("%.1f", y2) + "\"/>\n";
}

std::vector<double> ticks(const Axis& axis) {
  std::vector<double> values;
  if (axis.logarithmic)
    for (double d = axis.low; d <= axis.high + 0.5; ++d) values.push_back(std::pow(10, d));
  else
    for (int k = 0; k <= 5; ++k) values.push_back(axis.low + k * (axis.high - axis.low) / 5);
  return values;
}

void write_axes(std::ofstream& out, const Plot& plot, const Axis& x, const Axis& y) {
  for (const double value : ticks(x))
    out << line(x.at(value), top, x.at(value), bottom)
        << text(x.at(value), bottom + 18, number(x.logarithmic ? "%.0e" : "%.4g", value), "middle");
  for (const double value : ticks(y))
    out << line(left, y.at(value), right, y.at(value))
        << text(left - 6, y.at(value) + 4, number(y.logarithmic ? "%.0e" : "%.4g", value), "end");
  out << text((left + right) / 2, bottom + 36, plot.x_label, "middle")
      << text(left, top - 8, plot.y_label, "start")
      << text((left + right) / 2, 18, plot.title, "middle");
}

void write_series(std::ofstream& out, const PlotSeries& series, const Axis& x, const Axis& y,
                  std::size_t index) {
  const std::string colour = colours[index % colours.size()];
  std::string path, dots;
  for (const auto& [px, py] : series.points) {
    if (!x.shows(px) || !y.shows(py)) continue;
    const std::string cx = number("%.1f", x.at(px)), cy = number("%.1f", y.at(py));
    path += cx + "," + cy + " ";
    dots += "<circle cx=\"" + cx + "\" cy=\"" + cy + "\" r=\"3.5\" fill=\"" + colour + "\"/>\n";
  }
  if (series.with_line)
    out << "<polyline fill=\"none\" stroke=\"" << colour << "\" stroke-width=\"1.5\" points=\"" << path
        << "\"/>\n";
  if (series.with_dots) out << dots;
  out << "<g fill=\"" << colour << "\">"
      << text(legend, top + 16 * double(index + 1), series.name, "start") << "</g>\n";
}

}  // namespace

void write_plot(const Plot& plot, const std::filesystem::path& file) {
  Axis x{.logarithmic = plot.x_logarithmic, .from = left, .to = right};
  Axis y{.logarithmic = plot.y_logarithmic, .from = bottom, .to = top};
  for (const PlotSeries& series : plot.series)
    for (const auto& [px, py] : series.points)
      if (x.shows(px) && y.shows(py)) x.cover(px), y.cover(py);
  x.finish();
  y.finish();
  std::ofstream out(file);
  out << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"760\" height=\"430\" "
         "font-family=\"sans-serif\" font-size=\"12\">\n<style>.grid{stroke:#ddd}</style>\n"
         "<rect width=\"760\" height=\"430\" fill=\"white\"/>\n";
  write_axes(out, plot, x, y);
  for (std::size_t k = 0; k < plot.series.size(); ++k) write_series(out, plot.series[k], x, y, k);
  out << "</svg>\n";
}

}  // namespace souple::bench
