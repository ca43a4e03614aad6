#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "io/pictures/gnuplot.h"
#include "io/pictures/plots.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

// Between tics: 1, 2, 5, 10, ..., for no more than five of them.
double StepOf(const AxisRange& range) {
  double step = 1;
  for (int k = 0; (range.high - range.low) / step > 5; ++k) step *= k % 3 == 1 ? 2.5 : 2;
  return step;
}

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
                      : "unset logscale x\nset format x '%g'\nset xtics " +
                            GnuplotNumber(StepOf(range)) + "\n") +
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
                   int width, int height) {
  return "set label " + std::to_string(number) + " " + GnuplotQuote(text) + " at screen " +
         GnuplotNumber(static_cast<double>(x) / width) + "," + GnuplotNumber(1 - 30.0 / height) +
         " left front textcolor '" + color + "' offset 1.2,0 point pointtype " +
         std::to_string(point_type) + " pointsize 2 linewidth 2.5 linecolor '" + color + "'\n";
}

}  // namespace

void DrawTradeOff(std::span<const TradeOff> models, const std::string& path) {
  if (models.empty()) {
    throw Error(ErrorKind::kMissing, "there is no model to compare, so there is nothing to draw")
        .About("models");
  }
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
  // Room for the longest name, in letters of some 15 pixels.
  size_t longest = 0;
  for (const TradeOff& model : models) longest = std::max(longest, Shortened(model.name).size());
  const int left = std::max(272, 15 * static_cast<int>(longest) + 50), width = left + 1328;
  const int height = 190 + 44 * static_cast<int>(models.size());
  const auto from_top = [height](int pixels) { return GnuplotNumber(1 - pixels * 1.0 / height); };
  std::string script = GnuplotData("rows", rows);
  script += "set multiplot layout 1,3 margins " + GnuplotNumber(static_cast<double>(left) / width) +
            ",0.98," + GnuplotNumber(60.0 / height) + "," + from_top(105) +
            " spacing 0.035,0\nset format x '%g'\nset yrange [-0.6:" +
            GnuplotNumber(static_cast<double>(models.size()) - 0.4) + "]\n" +
            Legend(1, "full model", kOkabeIto[5], 6, left + 368, width, height) +
            Legend(2, "pruned model", kOkabeIto[4], 7, left + 578, width, height);
  script += "set ytics (" + names + ") noenhanced\n";
  script += Measure("parameters of the model [bytes]", 0, true, rows);
  script += "unset label\nset ytics (" + ticks + ")\n";
  script += Measure("time x threads to make it [s]", 1, true, rows);
  script += Measure("PSNR [dB]", 2, false, rows);
  DrawPng(path, width, height, script);
}

}  // namespace trilobe
