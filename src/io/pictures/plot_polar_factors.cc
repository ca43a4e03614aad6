#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/file_names.h"
#include "io/pictures/gnuplot.h"
#include "io/pictures/plot_factors.h"
#include "trilobe/core/base/stencil.h"

namespace trilobe {
namespace {

// In pixels.
constexpr int kMap = 340;  // across a disc
constexpr int kCellWidth = 565, kCellHeight = 480;
constexpr int kColumns = 3;
constexpr int kTop = 90;
constexpr int kWidth = kColumns * kCellWidth + 60;

constexpr int kPixels = 201;  // of the image that a disc is drawn by, along each side

int RowsOf(const std::vector<int>& maps) {
  return (static_cast<int>(maps.size()) + kColumns - 1) / kColumns;
}

// The tables of lobes that reflect something.
std::vector<int> Shown(const FactorModel& model, Factor factor) {
  std::vector<int> shown;
  for (int t = 0; t < model.spec().num_tables(factor); ++t) {
    const bool absent = model.spec().sharing(factor).per_lobe &&
                        ReflectsNothing(model, OwnerOf(model.spec(), factor, t).lobe);
    if (!absent) shown.push_back(t);
  }
  return shown;
}

// The values of a table over a disc, row by row from the top, NaN off it and where no data are.
std::vector<float> DiscOf(const ModelFile& file, Factor factor, int index) {
  const FactorModel& model = file.model;
  const Axis& axis = model.spec().axis(factor);
  const std::span<const double> table = model.table(factor, index);
  std::vector<float> disc;
  for (int row = 0; row < kPixels; ++row) {
    for (int column = 0; column < kPixels; ++column) {
      const double x = 2.0 * column / (kPixels - 1) - 1, y = 1 - 2.0 * row / (kPixels - 1);
      const double radius = std::hypot(x, y);
      float value = std::numeric_limits<float>::quiet_NaN();
      if (radius <= 1) {
        const Stencil at = axis.At(radius * DegreesToRadians(axis.theta.back()), std::atan2(y, x));
        bool unobserved = false;
        for (int k = 0; k < at.size; ++k) {
          unobserved =
              unobserved || file.unobserved[model.TableOffset(factor, index) + at.index[k]];
        }
        if (!unobserved) value = static_cast<float>(at(table));
      }
      disc.push_back(value);
    }
  }
  return disc;
}

std::string Bytes(std::span<const float> values) {
  std::string bytes;
  for (const float value : values) {
    const auto bits = std::bit_cast<uint32_t>(value);
    for (int k = 0; k < 4; ++k) bytes += static_cast<char>(bits >> (8 * k) & 0xFF);
  }
  return bytes;
}

// The colour scale: of D over as many decades as it has, four at most.
std::string ColorRange(std::span<const float> disc, bool logarithmic) {
  float low = std::numeric_limits<float>::infinity(), high = 0;
  for (const float x : disc) {
    if (x > 0) low = std::min(low, x);
    high = std::max(high, x);  // no NaN
  }
  if (!(high > 0)) low = high = 1;
  if (!logarithmic) {
    return "unset logscale cb\nset format cb '%g'\nset cbrange [0:" + GnuplotNumber(high) + "]\n";
  }
  low = std::clamp(low, high * 1e-4F, high * 0.5F);
  return "set logscale cb\nset format cb '%.2g'\nset cbrange [" + GnuplotNumber(low) + ":" +
         GnuplotNumber(high) + "]\n";
}

// One table as a disc: theta outwards, to the last node, and phi around.
std::string Map(const ModelFile& file, const LobeLight& light, Factor factor, int index, int x,
                int y, int canvas) {
  const Axis& axis = file.model.spec().axis(factor);
  const double last = axis.theta.back();
  std::vector<float> disc = DiscOf(file, factor, index);
  const bool is_D = factor == Factor::kD;
  const std::string range = ColorRange(disc, is_D);
  // Values below the scale get its darkest colour; a logarithm has no 0.
  if (is_D) {
    for (float& value : disc) value = std::max(value, std::numeric_limits<float>::min());
  }
  const std::string radius = GnuplotNumber(last);
  std::string script = PanelMargins(x, y, kMap, kMap, kWidth, canvas);
  script += range + "set xrange [-" + radius + ":" + radius + "]\nset yrange [-" + radius + ":" +
            radius + "]\nunset border\nunset tics\nunset xlabel\nunset ylabel\nunset grid\n" +
            "unset key\nset title '" + FactorName(factor) + (is_D ? " [1/sr], " : ", ") +
            TableName(file.model, light, factor, index) + "' offset 0,0.5 font ',18'\n" +
            "set object 1 circle at 0,0 size " + radius +
            " fillcolor rgb '#DDDDDD' fillstyle solid noborder behind\n";
  int object = 2, label = 10;
  for (const double ring : {30.0, 60.0, last}) {
    if (ring > last) continue;
    script += "set object " + std::to_string(object++) + " circle at 0,0 size " +
              GnuplotNumber(ring) +
              " fillstyle empty border linecolor '#FFFFFF' linewidth 1 front\n";
    const double along = ring * std::sqrt(0.5);
    script += "set label " + std::to_string(label++) + " '" + GnuplotNumber(ring) + "°' at " +
              GnuplotNumber(along) + "," + GnuplotNumber(-along) +
              (ring == last ? " left offset 0.3,-0.4 textcolor '#333333'"
                            : " center textcolor '#FFFFFF'") +
              " font ',13' front\n";
  }
  const struct {
    const char* text;
    double x, y;
  } kAround[] = {{"φ = 0", 1.2, 0}, {"90°", 0, 1.08}, {"180°", -1.15, 0}, {"270°", 0, -1.09}};
  for (const auto& [text, right, up] : kAround) {
    script += "set label " + std::to_string(label++) + " '" + text + "' at " +
              GnuplotNumber(right * last) + "," + GnuplotNumber(up * last) +
              " center font ',13' textcolor '#333333'\n";
  }
  script += "set colorbox user origin screen " + GnuplotNumber((x + kMap + 85.0) / kWidth) +
            ",screen " + GnuplotNumber(1 - (y + kMap - 20.0) / canvas) + " size screen " +
            GnuplotNumber(16.0 / kWidth) + ",screen " + GnuplotNumber((kMap - 40.0) / canvas) +
            " noborder\nset cbtics font ',13' out nomirror\nunset mcbtics\n";
  const double step = 2 * last / (kPixels - 1);
  // Rows come from the top.
  return script + "plot '-' binary array=(" + std::to_string(kPixels) + "," +
         std::to_string(kPixels) + ") origin=(-" + radius + ",-" + radius +
         ") dx=" + GnuplotNumber(step) + " dy=" + GnuplotNumber(step) +
         " flipy format='%float32' endian=little using 1 with image notitle\n" + Bytes(disc) +
         "unset label\nunset object\nunset title\nunset colorbox\n";
}

}  // namespace

void DrawPolarFactors(const ModelFile& file, const LobeLight& light, const std::string& path) {
  const FactorModel& model = file.model;
  const ModelSpec& spec = model.spec();
  const std::vector<int> shown[] = {Shown(model, Factor::kD), Shown(model, Factor::kG)};
  const int rows = RowsOf(shown[0]) + RowsOf(shown[1]);
  PanelRows curves(kWidth);
  std::vector<Panel> panels = CurvePanels(file, light, Factor::kF);
  panels.push_back(AlbedoPanel(light));
  curves.Add(std::move(panels), 2);
  const int canvas = kTop + rows * kCellHeight + curves.height();
  const std::string name = file.fit.source.empty() ? "model" : file.fit.source;
  int absent = 0;
  for (int m = 0; m < spec.lobes; ++m) absent += ReflectsNothing(model, m) ? 1 : 0;
  const std::string note =
      absent > 0 ? "; " + std::to_string(absent) + " lobes with s = 0 not drawn" : "";
  std::string script =
      "set multiplot\nset label 1 " +
      GnuplotTitle(
          "Factors: " + FileNameOf(name) + "  (θ outwards, φ around, grey: no data" + note + ")",
          kWidth, 22) +
      " at screen 0.5, screen " + GnuplotNumber(1 - 36.0 / canvas) +
      " center\n"
      "set palette defined (0 '#440154', 0.25 '#3B528B', 0.5 '#21918C', 0.75 '#5EC962', 1 "
      "'#FDE725')\n";
  int row = 0;
  for (const std::vector<int>& maps : shown) {
    const Factor factor = &maps == shown ? Factor::kD : Factor::kG;
    for (int k = 0; k < static_cast<int>(maps.size()); ++k) {
      script += Map(file, light, factor, maps[k], 75 + k % kColumns * kCellWidth,
                    kTop + (row + k / kColumns) * kCellHeight + 50, canvas);
    }
    row += RowsOf(maps);
  }
  DrawPng(path, kWidth, canvas,
          script + "set key noenhanced\n" + curves.Script(kTop + rows * kCellHeight, canvas));
}

}  // namespace trilobe
