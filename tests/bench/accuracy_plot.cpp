// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/accuracy_plot.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>

namespace souple::bench {
namespace {

constexpr double left = 70, right = 610, top = 40, bottom = 380;

// Decades onto pixels.
struct Axis {
  double low = 0, high = 1;  ///< decimal logarithms
  double from = 0, to = 1;   ///< pixels
  double at(double value) const {
    return from + (std::log10(value) - low) / (high - low) * (to - from);
  }
};

std::string text(const char* format, double a, double b, double c, double d) {
  char buffer[200];
  std::snprintf(buffer, sizeof buffer, format, a, b, c, d);
  return buffer;
}

std::string label(double x, double y, const std::string& what, const char* anchor = "middle") {
  return text("<text x=\"%.1f\" y=\"%.1f\" ", x, y, 0, 0) + "text-anchor=\"" + anchor + "\">" + what +
         "</text>\n";
}

void write_grid(std::ofstream& out, const Axis& x, const Axis& y) {
  for (double d = x.low; d <= x.high; ++d) {
    const double at = x.at(std::pow(10, d));
    out << text("<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" class=\"grid\"/>\n", at, top, at,
                bottom)
        << label(at, bottom + 18, "1e" + std::to_string(int(d)));
  }
  for (double d = y.low; d <= y.high; ++d) {
    const double at = y.at(std::pow(10, d));
    out << text("<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" class=\"grid\"/>\n", left, at,
                right, at)
        << label(left - 8, at + 4, "1e" + std::to_string(int(d)), "end");
  }
}

void write_curve(std::ofstream& out, const std::vector<AccuracyPoint>& curve,
                 SceneError AccuracyPoint::*scene, const Axis& x, const Axis& y,
                 const std::string& colour, const std::string& name, double legend_y) {
  out << "<polyline fill=\"none\" stroke=\"" << colour << "\" stroke-width=\"2\" points=\"";
  for (const auto& p : curve)
    out << text("%.1f,%.1f ", x.at(p.bytes), y.at(std::max((p.*scene).force, 1e-12)), 0, 0);
  out << "\"/>\n";
  for (const auto& p : curve)
    out << text("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4\" ", x.at(p.bytes),
                y.at(std::max((p.*scene).force, 1e-12)), 0, 0)
        << "fill=\"" << colour << "\"/>\n";
  out << "<g fill=\"" << colour << "\">" << label(right - 10, legend_y, name, "end") << "</g>\n";
}

void write_svg(const std::vector<AccuracyPoint>& curve, const std::filesystem::path& file) {
  Axis x{1e9, -1e9, left, right}, y{1e9, -1e9, bottom, top};
  for (const auto& p : curve) {
    x.low = std::min(x.low, std::floor(std::log10(p.bytes)));
    x.high = std::max(x.high, std::ceil(std::log10(p.bytes)));
    for (const double force : {p.drop.force, p.grip.force}) {
      y.low = std::min(y.low, std::floor(std::log10(std::max(force, 1e-12))));
      y.high = std::max(y.high, std::ceil(std::log10(std::max(force, 1e-12))));
    }
  }
  x.high = std::max(x.high, x.low + 1);
  y.high = std::max(y.high, y.low + 1);
  std::ofstream out(file);
  out << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"640\" height=\"430\" "
         "font-family=\"sans-serif\" "
         "font-size=\"12\">\n<style>.grid{stroke:#ddd}</style>\n"
         "<rect width=\"640\" height=\"430\" fill=\"white\"/>\n";
  write_grid(out, x, y);
  write_curve(out, curve, &AccuracyPoint::drop, x, y, "#1f5fa8", "drop", top + 18);
  write_curve(out, curve, &AccuracyPoint::grip, x, y, "#c0392b", "grip", top + 36);
  for (const auto& p : curve) {
    char tolerance[16];
    std::snprintf(tolerance, sizeof tolerance, "%.0e", p.tolerance);
    out << label(x.at(p.bytes), y.at(std::max({p.drop.force, p.grip.force, 1e-12})) - 10, tolerance);
  }
  out << label((left + right) / 2, bottom + 38, "bytes of C0, without container")
      << label((left + right) / 2, top - 16,
               "relative error of the contact forces, by tolerance of the compression")
      << "</svg>\n";
}

}  // namespace

void write_accuracy(const std::vector<AccuracyPoint>& curve, const std::filesystem::path& folder) {
  std::ofstream csv(folder / "compliance_accuracy.csv");
  csv << "tolerance,bytes,drop_force,drop_shape,grip_force,grip_shape\n";
  for (const auto& p : curve)
    csv << p.tolerance << ',' << p.bytes << ',' << p.drop.force << ',' << p.drop.shape << ','
        << p.grip.force << ',' << p.grip.shape << '\n';
  write_svg(curve, folder / "compliance_accuracy.svg");
}

}  // namespace souple::bench
