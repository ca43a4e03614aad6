#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/base/file_names.h"
#include "io/formats/databases/utia_file.h"
#include "io/pictures/gnuplot.h"
#include "io/pictures/plots.h"
#include "trilobe/model/measurement/measurement_stats.h"

namespace trilobe {
namespace {

// Dashed lines where nothing is measured any more, and the angle on the upper one.
std::string LimitLines(double max_theta) {
  const std::string limit = GnuplotNumber(RadiansToDegrees(max_theta));
  const std::string style = " nohead front dashtype 2 linewidth 2 linecolor '#000000'\n";
  return "set arrow from " + limit + ",0 to " + limit + "," + limit + style + "set arrow from 0," +
         limit + " to " + limit + "," + limit + style + "set label sprintf('%.4g°', " + limit +
         ") at 1.5," + limit + " offset 0,0.7 front textcolor '#000000'\n";
}

}  // namespace

void DrawMeasured(const BrdfTable& table, const std::string& path) {
  constexpr int kCells = 90;
  const std::vector<double> shares = ValidShares(table);
  std::vector<std::vector<double>> rows;  // of theta_o, with theta_i in columns
  for (int o = 0; o < kCells; ++o) {
    std::vector<double>& row = rows.emplace_back();
    for (int i = 0; i < kCells; ++i) row.push_back(shares[i * kCells + o]);
  }
  const std::string name = FileNameOf(table.source);
  std::string script = GnuplotData("cells", rows);
  script += "set title " + GnuplotQuote("What was measured of " + name) +
            " noenhanced font ',22' offset 0,0.4\n"
            "set xlabel 'θ_i [°]'\nset ylabel 'θ_o [°]'\n"
            "set xrange [0:90]\nset yrange [0:90]\nset size ratio 1\n"
            "set xtics 15\nset ytics 15\nunset grid\nset border 15\n"
            "set lmargin at screen 0.10\nset rmargin at screen 0.80\n"
            "set tmargin at screen 0.91\nset bmargin at screen 0.12\n"
            // No end is white, which is for cells without a bin; the ends differ in brightness.
            "set palette defined (0 '#F6CFA8', 0.5 '#6FA3C8', 1 '#0B3C6F')\n"
            "set cbrange [0:1]\nset cbtics ('none' 0, '25 %%' 0.25, '50 %%' 0.5, '75 %%' 0.75, "
            "'all' 1)\nset cblabel 'valid of the bins above the surface (white: no bin)' "
            "offset 1.5,0\n";
  if (table.max_theta < kPi / 2) script += LimitLines(table.max_theta);
  script += "plot $cells matrix using ($1+0.5):($2+0.5):3 with image notitle\n";
  DrawPng(path, 1200, 1080, script);
}

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
  const std::string name = FileNameOf(scattered.source);
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
