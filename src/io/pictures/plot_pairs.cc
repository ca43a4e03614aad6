#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "io/formats/utia_file.h"
#include "io/pictures/gnuplot.h"
#include "io/pictures/plots.h"

namespace trilobe {

void DrawPairs(const Measurement& scattered, const std::string& path) {
  const NodeTable values = ValuesAtNodes(scattered, kUtiaGrid);
  constexpr int kNodes = kUtiaGrid.nodes();
  std::vector<std::vector<double>> rows(kNodes);
  double largest = 0;
  for (int i = 0; i < kNodes; ++i) {
    for (int o = 0; o < kNodes; ++o) {
      const size_t pair = static_cast<size_t>(i) * kNodes + o;
      const double mean =
          Mean(values.rho[pair]) * std::cos(kUtiaGrid.Theta(i)) * std::cos(kUtiaGrid.Theta(o));
      largest = std::max(largest, mean);
      rows[i].push_back(values.present[pair] ? mean : std::numeric_limits<double>::quiet_NaN());
    }
  }
  // Black stands for no more than this part of the largest value; NaN stays what it is.
  const double top = largest > 0 ? largest : 1, bottom = 1e-4 * top;
  for (std::vector<double>& row : rows) {
    for (double& value : row) value = value < bottom ? bottom : value;
  }
  std::string tics;
  for (int a = 0; a < kUtiaGrid.thetas; ++a) {
    tics += (a == 0 ? "" : ", ") + std::string("'") + std::to_string(15 * a) + "°' " +
            std::to_string(kUtiaGrid.phis * a);
  }
  const std::string name = std::filesystem::path(scattered.source).filename().string();
  std::string script = GnuplotData("pairs", rows);
  script += "set title " + GnuplotQuote("What was measured of " + name) +
            " noenhanced font ',22' offset 0,0.4\n"
            "set xlabel 'θ_o, and φ_o from 0° to 360° in each'\n"
            "set ylabel 'θ_i, and φ_i from 0° to 360° in each'\n"
            "set xrange [0:288]\nset yrange [0:288]\nset size ratio 1\nunset grid\nset border 15\n"
            "set xtics (" +
            tics + ")\nset ytics (" + tics +
            ")\n"
            "set lmargin at screen 0.10\nset rmargin at screen 0.80\n"
            "set tmargin at screen 0.91\nset bmargin at screen 0.12\n"
            "set palette defined (0 '#000000', 0.35 '#0B3C6F', 0.7 '#6FA3C8', 1 '#F6E8CF')\n"
            "set logscale cb\nset format cb '10^{%T}'\nset cbrange [" +
            GnuplotNumber(bottom) + ":" + GnuplotNumber(top) +
            "]\nset cblabel 'ρ cos θ_i cos θ_o, mean of the channels [1/sr] (white: no value)' "
            "offset 1.5,0\n"
            "plot $pairs matrix using ($1+0.5):($2+0.5):3 with image notitle\n";
  DrawPng(path, 1200, 1080, script);
}

}  // namespace trilobe
