#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "io/pictures/gnuplot.h"
#include "io/pictures/plots.h"

namespace trilobe {
namespace {

constexpr int kCurves = 5;
constexpr double kThetaD[kCurves] = {5, 25, 45, 65, 80};  // degrees; the bins that begin there
// Dark to light, apart in brightness as well as in hue.
constexpr const char* kColors[kCurves] = {"#000000", "#0072B2", "#009E73", "#D55E00", "#E69F00"};

}  // namespace

void DrawSlices(const BrdfTable& measured, const BrdfTable& fitted, const std::string& path) {
  const MerlGrid& grid = measured.grid;
  const std::vector<bool> valid = ValidBins(measured), drawable = ValidBins(fitted);
  const int p = grid.phi_d / 2;
  std::string data;
  std::vector<double> values;
  for (int c = 0; c < kChannels; ++c) {
    std::vector<std::vector<double>> rows;  // sqrt(theta_h), then measured, fitted for each theta_d
    for (int h = 0; h < grid.theta_h; ++h) {
      std::vector<double> row = {std::sqrt(RadiansToDegrees(grid.ThetaH(h + 0.5)))};
      for (const double theta_d : kThetaD) {
        const int d = static_cast<int>(theta_d / 90 * grid.theta_d);
        const int bin = grid.Index(h, d, p);
        for (const bool of_fit : {false, true}) {
          const bool known = of_fit ? drawable[bin] : valid[bin];
          const double x = known ? (of_fit ? fitted : measured).Value(c, bin) : 0;
          row.push_back(x > 0 ? x : std::numeric_limits<double>::quiet_NaN());
          // The axis is for what was measured: where nothing was, the fit may be anything.
          if (valid[bin]) values.push_back(x);
        }
      }
      rows.push_back(row);
    }
    data += GnuplotData("channel" + std::to_string(c), rows);
  }

  std::string script = data;
  script += "set multiplot title " +
            GnuplotTitle("Measured (points) and fitted (lines): " + PictureName(measured.source),
                         2000, 22) +
            "\n"
            "set logscale y\n"
            "set format y '10^{%T}'\n"
            "set xrange [0:sqrt(90)]\n"
            "set yrange " +
            GnuplotLogRange(values, 9) +
            "\nset xtics ('0' 0, '1' 1, '5' sqrt(5), '15' sqrt(15), '30' sqrt(30), "
            "'60' sqrt(60), '90' sqrt(90))\n"
            "set xlabel 'θ_h [°], spaced by its root'\n"
            "set tmargin at screen 0.865\nset bmargin at screen 0.125\n";
  for (int c = 0; c < kChannels; ++c) {
    const double left = 0.07 + 0.275 * c;
    script += "set lmargin at screen " + GnuplotNumber(left) + "\nset rmargin at screen " +
              GnuplotNumber(left + 0.25) + "\nset title '" + kChannelNames[c] + "' offset 0,-0.4\n";
    script +=
        c == 0 ? "set ylabel 'BRDF [1/sr] at φ_d ≈ 90°'\n" : "unset ylabel\nset format y ''\n";
    script +=
        c == 2 ? "set key at screen 0.995, screen 0.52 right center vertical spacing 1.5 enhanced\n"
               : "unset key\n";
    script += "plot ";
    for (int k = 0; k < kCurves; ++k) {
      const std::string block = "$channel" + std::to_string(c);
      const int d = static_cast<int>(kThetaD[k] / 90 * grid.theta_d);
      script += (k == 0 ? "" : ", ") + block + " using 1:" + std::to_string(2 + 2 * k) +
                " with points pointtype 7 pointsize 0.75 linecolor '" + kColors[k] +
                "' notitle, '' using 1:" + std::to_string(3 + 2 * k) +
                " with lines linewidth 2.2 linecolor '" + kColors[k] +
                "' title 'θ_d = " + GnuplotNumber(RadiansToDegrees(grid.ThetaD(d + 0.5))) + "°'";
    }
    script += '\n';
  }
  DrawPng(path, 2000, 1000, script);
}

}  // namespace trilobe
