#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "trilobe/base/error.h"
#include "trilobe/io/gnuplot.h"
#include "trilobe/io/plots.h"

namespace trilobe {
namespace {

// A panel of `rows`: columns 0 (height), 2k + 1 (full) and 2k + 2 (pruned) for axis k.
std::string Measure(const char* title, int axis, bool logarithmic,
                    const std::vector<std::vector<double>>& rows) {
  std::vector<double> values;
  for (const std::vector<double>& row : rows) {
    for (const double x : {row[2 * axis + 1], row[2 * axis + 2]}) {
      if (std::isfinite(x) && (x > 0 || !logarithmic)) values.push_back(x);
    }
  }
  if (values.empty()) values.push_back(1);
  const auto [low, high] = std::ranges::minmax(values);
  const AxisRange range =
      logarithmic ? AxisRange{low / 1.6, high * 1.6} : AxisRange{low - 1, high + 1};
  const std::string full = std::to_string(2 * axis + 2), pruned = std::to_string(2 * axis + 3);
  return (logarithmic ? "set logscale x\n" + LogTics(range, 'x')
                      : std::string("unset logscale x\nset format x '%g'\nset xtics autofreq\n")) +
         "set xrange [" + GnuplotNumber(range.low) + ":" + GnuplotNumber(range.high) +
         "]\nset title " + GnuplotQuote(title) + "\nplot $rows using " + full + ":1:($" + pruned +
         "-$" + full +
         "):(0) with vectors nohead linewidth 2 linecolor '#BBBBBB' notitle, '' using " + full +
         ":1 with points pointtype 6 pointsize 2 linewidth 2.5 linecolor '" + kOkabeIto[5] +
         "' notitle, '' using " + pruned + ":1 with points pointtype 7 pointsize 1.6 linecolor '" +
         kOkabeIto[4] + "' notitle\n";
}

// Names of scenes' materials are ASCII; one too long for its room ends in dots.
std::string Shortened(const std::string& name) {
  constexpr size_t kLetters = 48;
  return name.size() <= kLetters ? name : name.substr(0, kLetters - 1) + "…";
}

// A mark and its meaning, in pixels from the top left.
std::string Legend(int number, const char* text, const char* color, int point_type, int x,
                   int height) {
  return "set label " + std::to_string(number) + " " + GnuplotQuote(text) + " at screen " +
         GnuplotNumber(x / 1600.0) + "," + GnuplotNumber(1 - 30.0 / height) +
         " left front textcolor '" + color + "' offset 1.2,0 point pointtype " +
         std::to_string(point_type) + " pointsize 2 linewidth 2.5 linecolor '" + color + "'\n";
}

}  // namespace

void DrawTradeOff(std::span<const TradeOff> models, const std::string& path) {
  if (models.empty()) throw Error("there is no model to compare, so there is nothing to draw");
  std::vector<std::vector<double>> rows;
  std::string names, ticks;
  for (size_t k = 0; k < models.size(); ++k) {
    const auto& [name, full, pruned] = models[k];
    const auto y = static_cast<double>(models.size() - 1 - k);  // the first one on top
    rows.push_back({y, full.bytes, pruned.bytes, full.core_seconds, pruned.core_seconds,
                    full.psnr_db, pruned.psnr_db});
    const std::string comma = k == 0 ? "" : ", ";
    names += comma + GnuplotQuote(Shortened(name)) + " " + GnuplotNumber(y);
    ticks += comma + "'' " + GnuplotNumber(y);
  }
  // Room for the longest name, in letters of some 15 pixels, but no more than for the panels.
  constexpr int kWidth = 1600;
  size_t longest = 0;
  for (const TradeOff& model : models) longest = std::max(longest, model.name.size());
  const double left = std::clamp(15.0 * static_cast<double>(longest) + 50, 272.0, 0.5 * kWidth);
  const int height = 190 + 44 * static_cast<int>(models.size());
  const auto from_top = [height](int pixels) { return GnuplotNumber(1 - pixels * 1.0 / height); };
  std::string script = GnuplotData("rows", rows);
  script += "set multiplot layout 1,3 margins " + GnuplotNumber(left / kWidth) + ",0.98," +
            GnuplotNumber(60.0 / height) + "," + from_top(105) +
            " spacing 0.035,0\nset format x '%g'\nset yrange [-0.6:" +
            GnuplotNumber(static_cast<double>(models.size()) - 0.4) + "]\n" +
            Legend(1, "full model", kOkabeIto[5], 6, 640, height) +
            Legend(2, "pruned model", kOkabeIto[4], 7, 850, height);
  script += "set ytics (" + names + ") noenhanced\n";
  script += Measure("parameters of the model [bytes]", 0, true, rows);
  script += "unset label\nset ytics (" + ticks + ")\n";
  script += Measure("time x threads to make it [s]", 1, true, rows);
  script += Measure("PSNR [dB]", 2, false, rows);
  DrawPng(path, 1600, height, script);
}

}  // namespace trilobe
