// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace souple::bench {

struct PlotSeries {
  std::string name;
  std::vector<std::pair<double, double>> points;
  bool with_line = true;
  bool with_dots = false;
};

struct Plot {
  std::string title, x_label, y_label;
  bool x_logarithmic = false;
  std::vector<PlotSeries> series;
  bool y_logarithmic = true;
};

/// As SVG; points that are not above zero on a logarithmic axis are left out.
void write_plot(const Plot& plot, const std::filesystem::path& file);

}  // namespace souple::bench
