#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "trilobe/base/error.h"
#include "trilobe/io/gnuplot.h"
#include "trilobe/io/plots.h"

namespace trilobe {
namespace {

// A row a model: both ends on an axis of its own.
std::string Panel(const char* title, int column, bool logarithmic) {
  const std::string x_full = std::to_string(column), x_pruned = std::to_string(column + 1);
  return std::string("set title ") + GnuplotQuote(title) + "\n" +
         (logarithmic ? "set logscale x\nset format x '%g'\n"
                      : "unset logscale x\nset format x '%g'\n") +
         "plot $rows using " + x_full + ":1:($" + x_pruned + "-$" + x_full +
         "):(0) with vectors nohead linewidth 2 linecolor '#BBBBBB' notitle, '' using " + x_full +
         ":1 with points pointtype 6 pointsize 2 linewidth 2.5 linecolor '" + kOkabeIto[5] +
         "' notitle, '' using " + x_pruned + ":1 with points pointtype 7 pointsize 2 linecolor '" +
         kOkabeIto[4] + "' notitle\n";
}

}  // namespace

void DrawTradeOff(std::span<const TradeOff> rows, const std::string& path) {
  if (rows.empty()) throw Error("there is no model to compare, so there is nothing to draw");
  std::vector<std::vector<double>> data;
  std::string names;
  for (size_t k = 0; k < rows.size(); ++k) {
    const auto& [name, full, pruned] = rows[k];
    const auto y = static_cast<double>(rows.size() - 1 - k);  // the first one on top
    data.push_back(
        {y, full.bytes, pruned.bytes, full.seconds, pruned.seconds, full.psnr_db, pruned.psnr_db});
    names += (names.empty() ? "" : ", ") + GnuplotQuote(name) + " " + GnuplotNumber(y);
  }
  std::string script = GnuplotData("rows", data);
  script +=
      "set multiplot layout 1,3 margins 0.16,0.98,0.14,0.86 spacing 0.02,0.1\n"
      "set label 1 'full' at screen 0.43,0.95 left front textcolor '" +
      std::string(kOkabeIto[5]) +
      "' offset 2 point pointtype 6 pointsize 2 linewidth 2.5 linecolor '" + kOkabeIto[5] +
      "'\nset label 2 'pruned' at screen 0.53,0.95 left front textcolor '" + kOkabeIto[4] +
      "' offset 2 point pointtype 7 pointsize 2 linecolor '" + kOkabeIto[4] +
      "'\nset xlabel ' '\nset yrange [-0.6:" +
      GnuplotNumber(static_cast<double>(rows.size()) - 0.4) + "]\nset ytics (" + names +
      ") noenhanced\n";
  script += Panel("numbers of the model [bytes]", 2, true);
  script += "unset label 1\nunset label 2\nset ytics format ''\n";
  script += Panel("seconds to make it", 4, true);
  script += Panel("PSNR [dB]", 6, false);
  const int height = 260 + 44 * static_cast<int>(rows.size());
  DrawPng(path, 1600, height, script);
}

}  // namespace trilobe
