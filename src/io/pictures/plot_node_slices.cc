#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "io/pictures/gnuplot.h"
#include "io/pictures/plots.h"

namespace trilobe {
namespace {

// Dark to light, apart in brightness as well as in hue.
constexpr const char* kColors[] = {"#000000", "#0072B2", "#009E73", "#D55E00", "#E69F00"};
constexpr int kCurves = std::size(kColors);
constexpr int kSteps = 360;   // of a fitted line
constexpr int kWidth = 2000;  // pixels

// A row of panels: at each of a few thetas, values around the normal.
struct Row {
  const char* title;
  const char* x;      // of the axis
  const char* curve;  // what differs between curves
  // Angles of a curve at this theta and phi [rad].
  SphericalAngles (*at)(double theta, double phi, double middling);
};
constexpr Row kRows[] = {
    {"seen along the normal, as the sample turns", "φ_i [°]", "θ_i",
     [](double theta, double phi, double) {
       return SphericalAngles{theta, phi, 0, 0};
     }},
    {"lit from φ_i = 0", "φ_o [°]", "θ_o",
     [](double theta, double phi, double middling) {
       return SphericalAngles{middling, 0, theta, phi};
     }},
};

// Up to kCurves of the grid's thetas, evenly, the largest that was measured among them.
std::vector<double> ThetasOf(const NodeTable& table) {
  const int last = std::min(static_cast<int>(table.max_theta / table.grid.ThetaStep() + 1e-6),
                            table.grid.thetas - 1);
  std::vector<double> thetas;
  const int curves = std::min(kCurves, std::max(last, 1));
  for (int k = 1; k <= curves; ++k) {
    thetas.push_back(static_cast<double>(std::lround(static_cast<double>(last) * k / curves)) *
                     table.grid.ThetaStep());
  }
  return thetas;
}

std::string Degrees(double radians) {
  return GnuplotNumber(std::round(RadiansToDegrees(radians) * 100) / 100) + "°";
}

}  // namespace

void DrawSlices(const NodeBrdf& measured, const SphericalBrdf& fitted, const std::string& path) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const NodeTable& table = measured.table();
  const std::vector<double> thetas = ThetasOf(table);
  const double middling = thetas[thetas.size() / 2];
  const auto positive = [](double x) { return x > 0 ? x : kNone; };
  std::string script;
  std::array<std::vector<double>, std::size(kRows)> values;
  for (size_t r = 0; r < std::size(kRows); ++r) {
    for (int c = 0; c < kChannels; ++c) {
      std::vector<std::vector<double>> points, lines;  // phi, then each theta
      for (int b = 0; b <= table.grid.phis; ++b) {
        std::vector<double>& row = points.emplace_back(1, 360.0 * b / table.grid.phis);
        for (const double theta : thetas) {
          const SphericalAngles at = kRows[r].at(theta, b * table.grid.PhiStep(), middling);
          row.push_back(measured.Measured(at) ? positive(measured(at)[c]) : kNone);
          values[r].push_back(row.back());
        }
      }
      for (int k = 0; k <= kSteps; ++k) {
        std::vector<double>& row = lines.emplace_back(1, 360.0 * k / kSteps);
        for (const double theta : thetas) {
          row.push_back(positive(fitted(kRows[r].at(theta, 2 * kPi * k / kSteps, middling))[c]));
        }
      }
      const std::string name = std::to_string(r) + "_" + std::to_string(c);
      script += GnuplotData("points" + name, points) + GnuplotData("lines" + name, lines);
    }
  }
  script += "set multiplot title " +
            GnuplotTitle("Measured (points) and fitted (lines): " + PictureName(table.source),
                         kWidth, 22) +
            "\nset logscale y\nset xrange [0:360]\nset xtics 0,60,360\n";
  for (size_t r = 0; r < std::size(kRows); ++r) {
    const double top = 0.865 - 0.465 * static_cast<double>(r), bottom = top - 0.325;
    script += "set tmargin at screen " + GnuplotNumber(top) + "\nset bmargin at screen " +
              GnuplotNumber(bottom) + "\nset yrange " + GnuplotLogRange(values[r], 6) +
              "\nset label 1 '" + kRows[r].title + (r == 1 ? ", θ_i = " + Degrees(middling) : "") +
              "' at screen 0.47, screen " + GnuplotNumber(top + 0.05) + " center font ',19'\n";
    for (int c = 0; c < kChannels; ++c) {
      const double left = 0.085 + 0.27 * c;
      script += "set lmargin at screen " + GnuplotNumber(left) + "\nset rmargin at screen " +
                GnuplotNumber(left + 0.245) + "\nset title '" + kChannelNames[c] +
                "' offset 0,-0.4\nset xlabel '" + kRows[r].x + "'\n";
      script += c == 0 ? "set ylabel 'BRDF [1/sr]'\n" + LogTics(LogRange(values[r], 6), 'y')
                       : std::string("unset ylabel\nset format y ''\n");
      script += c == 2 ? "set key at screen 0.995, screen " + GnuplotNumber((top + bottom) / 2) +
                             " right center vertical spacing 1.5 enhanced\n"
                       : "unset key\n";
      const std::string name = std::to_string(r) + "_" + std::to_string(c);
      for (size_t k = 0; k < thetas.size(); ++k) {
        const std::string column = std::to_string(2 + k);
        script += (k == 0 ? "plot $points" : ", $points") + name + " using 1:" + column +
                  " with points pointtype 7 pointsize 0.75 linecolor '" + kColors[k] +
                  "' notitle, $lines" + name + " using 1:" + column +
                  " with lines linewidth 2.2 linecolor '" + kColors[k] + "' title '" +
                  kRows[r].curve + " = " + Degrees(thetas[k]) + "'";
      }
      script += "\nunset label\n";
    }
  }
  DrawPng(path, kWidth, 1400, script);
}

}  // namespace trilobe
