#include "trilobe/io/plot_factors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "trilobe/io/gnuplot.h"
#include "trilobe/io/plots.h"
#include "trilobe/math/catmull_rom.h"
#include "trilobe/model/gauge.h"
#include "trilobe/model/lobe_light.h"

namespace trilobe {
namespace {

// Of the light through a table, for an entry to be seen on the axis of its picture.
constexpr double kLightThatCounts = 1e-4;

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kDash[] = {"solid", "'-'", "'.'", "'_.'", "'..-'", "'-_'", "'--.'", "'_'"};

// "62 %", "<0.1 %", for gnuplot, which takes the labels of tics for formats.
std::string Percent(double share) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), share >= 0.0995 ? "%.0f" : "%.1f", 100 * share);
  return (share > 0 && share < 0.0005 ? "<0.1" : std::string(text.data())) + " %%";
}

std::string LobeName(int lobe) { return "lobe " + std::to_string(lobe + 1); }

// What stands behind the name of a lobe that is dark.
const char* AbsenceOf(const FactorModel& model, int lobe) {
  return Absent(model, lobe) ? " (s = 0)" : "";
}

// Legend of curves that differ in colour by their channel and in dashes by their lobe.
std::string LegendByChannelAndLobe(const FactorModel& model) {
  std::string legend;
  const auto add = [&](const std::string& color, const std::string& dash, const std::string& name) {
    legend += ", NaN with lines linewidth 2.5 linecolor '" + color + "' dashtype " + dash +
              " title '" + name + "'";
  };
  for (int c = 0; c < kChannels; ++c) add(kChannelColors[c], "solid", kChannelNames[c]);
  for (int m = 0; m < model.spec().lobes; ++m) {
    add("#555555", kDash[m], LobeName(m) + AbsenceOf(model, m));
  }
  return legend;
}

}  // namespace

bool Absent(const FactorModel& model, int lobe) {
  return std::ranges::all_of(model.s(lobe), [](double s) { return s == 0; });
}

TableOwner OwnerOf(const ModelSpec& spec, Factor factor, int index) {
  const TableSharing& sharing = spec.sharing(factor);
  const int channels = sharing.per_channel ? kChannels : 1;
  return {sharing.per_lobe ? index / channels : 0, sharing.per_channel ? index % channels : 0};
}

std::string TableName(const FactorModel& model, Factor factor, int index) {
  const ModelSpec& spec = model.spec();
  const TableSharing& sharing = spec.sharing(factor);
  const auto [lobe, channel] = OwnerOf(spec, factor, index);
  std::string name;
  if (sharing.per_lobe && (spec.lobes > 1 || !sharing.per_channel)) name = LobeName(lobe);
  if (sharing.per_channel) name += (name.empty() ? "" : ", ") + std::string(kChannelNames[channel]);
  if (name.empty()) name = "all lobes";
  return sharing.per_lobe ? name + AbsenceOf(model, lobe) : name;
}

std::string CurvesPanel(const ModelFile& file, const LobeLight& light, Factor factor,
                        const std::vector<double>& positions, bool logarithmic) {
  const FactorModel& model = file.model;
  const ModelSpec& spec = model.spec();
  std::string data, curves, hollow;
  std::vector<double> values;
  bool any_unobserved = false;
  const bool by_channel = spec.sharing(factor).per_channel;
  const bool by_both = by_channel && spec.sharing(factor).per_lobe && spec.lobes > 1;
  for (int t = 0; t < spec.num_tables(factor); ++t) {
    const auto [lobe, channel] = OwnerOf(spec, factor, t);
    const bool absent = spec.sharing(factor).per_lobe && Absent(model, lobe);
    const std::span<const double> table = model.table(factor, t);
    std::vector<std::vector<double>> rows;  // abscissa, value, value where unobserved
    for (int i = 0; i < static_cast<int>(table.size()); ++i) {
      const bool unobserved = file.unobserved[model.TableOffset(factor, t) + i];
      const bool drawn = !absent;
      any_unobserved = any_unobserved || (unobserved && drawn);
      rows.push_back(
          {positions[i], drawn ? table[i] : kGap, drawn && unobserved ? table[i] : kGap});
    }
    const auto through =
        std::span(light.through).subspan(model.TableOffset(factor, t), table.size());
    const double enough = kLightThatCounts * std::accumulate(through.begin(), through.end(), 0.0);
    for (size_t i = 0; i < table.size() && !absent; ++i) {
      if (through[i] >= enough) values.push_back(table[i]);
    }
    const std::string block = std::string(FactorName(factor)) + std::to_string(t);
    data += GnuplotData(block, rows);
    const std::string style = std::string("linecolor '") +
                              (by_channel ? kChannelColors[channel] : kLobeColors[lobe]) + "'";
    curves += (t == 0 ? "plot $" : ", $") + block + " using 1:2 with ";
    curves += absent ? "dots linecolor '#FFFFFF'"
                     : "lines linewidth 2.5 " + style + " dashtype " +
                           (by_channel ? kDash[lobe] : "solid");
    curves += by_both ? " notitle" : " title '" + TableName(model, factor, t) + "'";
    hollow +=
        ", $" + block + " using 1:3 with points pointtype 6 pointsize 1.1 " + style + " notitle";
  }
  if (values.empty()) return "";
  if (by_both) curves += LegendByChannelAndLobe(model);
  if (any_unobserved) {
    curves +=
        hollow + ", NaN with points pointtype 6 pointsize 1.1 linecolor '#555555' title 'no data'";
  }
  // Linear as in the paper, unless a peak would flatten all the rest.
  std::vector<double> sorted = values;
  std::ranges::sort(sorted);
  const double top = sorted.back();
  const double spread =
      top / std::max(sorted[sorted.size() / 2], std::numeric_limits<double>::min());
  if (logarithmic || spread > 10) {
    return data + "set logscale y\nset format y '10^{%T}'\nset yrange " +
           GnuplotLogRange(values, logarithmic ? 9 : 4) + "\n" + curves;
  }
  return data + "unset logscale y\nset format y '%g'\nset yrange [0:" +
         GnuplotNumber(top > 0 ? top * 1.08 : 1) + "]\n" + curves;
}

std::string AlbedoPanel(const LobeLight& light) {
  const int groups = 1 + static_cast<int>(light.lobes.size());
  std::string data[kChannels], tics;
  double top = 0;
  for (int g = 0; g < groups; ++g) {
    const Rgb& values = g == 0 ? light.diffuse : light.lobes[g - 1];
    for (int c = 0; c < kChannels; ++c) {
      data[c] += GnuplotNumber(g + 0.28 * (c - 1)) + " " + GnuplotNumber(values[c]) + "\n";
      top = std::max(top, values[c]);
    }
    const std::string name = g == 0 ? "diffuse" : LobeName(g - 1);
    const double share = g == 0 ? light.DiffuseShare() : light.Share(g - 1);
    tics += (g == 0 ? "\"" : ", \"") + name + "\\n" + Percent(share) + "\" " + std::to_string(g);
  }
  std::string script, plot;
  const std::string font = groups <= 4 ? ",14" : ",11";
  const std::string tic_font = groups <= 6 ? "" : " font ',12'";
  for (int c = 0; c < kChannels; ++c) {
    const std::string block = "$coefficient" + std::to_string(c);
    script += block + " << EOD\n" + data[c] + "EOD\n";
    plot += (c == 0 ? "plot " : ", ") + block + " using 1:2 with boxes linecolor '" +
            kChannelColors[c] + "' title '" + kChannelNames[c] + "', '' using 1:2:" +
            "(sprintf('%.3g', $2)) with labels rotate by 90 left offset 0,0.4 font '" + font +
            "' notitle";
  }
  return script + "unset logscale y\nset format y '%g'\nset yrange [0:" +
         GnuplotNumber(top > 0 ? 1.35 * top : 1) +
         "]\nset xrange [-0.6:" + GnuplotNumber(groups - 0.4) + "]\nset xtics (" + tics + ")" +
         tic_font + "\nset boxwidth 0.26\nset style fill solid 0.85 noborder\n" + plot;
}

void DrawFactors(const ModelFile& file, const std::string& path) {
  CheckDrawable(file, {});
  const ModelSpec& spec = file.model.spec();
  const std::string name = file.fit.source.empty() ? "model" : file.fit.source;
  const LobeLight light = ComputeLobeLight(ObservedEntries(file.unobserved), file.model);
  if (spec.anisotropic()) {
    DrawPolarFactors(file, light, path);
    return;
  }
  // Where the entries of a table stand [degrees].
  const auto degrees = [&](Factor factor) {
    std::vector<double> thetas;
    for (int i = 0; i < spec.table_size(factor); ++i) {
      thetas.push_back(RadiansToDegrees(spec.axis(factor).Theta(i)));
    }
    return thetas;
  };
  std::vector<double> roots = degrees(Factor::kD);
  for (double& x : roots) x = std::sqrt(x);
  constexpr double kLeft = 0.085, kRight = 0.975, kBottom = 0.075, kTop = 0.865;  // of the canvas
  constexpr double kColumnGap = 0.11, kRowGap = 0.19;
  std::string script = "set multiplot layout 2,2 margins " + GnuplotNumber(kLeft) + "," +
                       GnuplotNumber(kRight) + "," + GnuplotNumber(kBottom) + "," +
                       GnuplotNumber(kTop) + " spacing " + GnuplotNumber(kColumnGap) + "," +
                       GnuplotNumber(kRowGap) + " title " + GnuplotQuote("Factors: " + name) +
                       " noenhanced font ',22'\n";
  // Panels in reading order, each with its title and a legend above it, where no curve can be.
  int index = 0;
  const auto panel = [&](const char* title, const std::string& setup, const std::string& plot) {
    const double width = (kRight - kLeft - kColumnGap) / 2;
    const double x = kLeft + width / 2 + (index % 2) * (width + kColumnGap);
    const double y = index / 2 == 0 ? kTop : (kTop + kBottom - kRowGap) / 2;
    ++index;
    const std::string center = " at screen " + GnuplotNumber(x) + ", screen ";
    script += std::string("set label 1 '") + title + "'" + center + GnuplotNumber(y + 0.07) +
              " center font ',19'\nset key" + center + GnuplotNumber(y + 0.058) +
              " center top horizontal maxrows 2 font ',16'\n" + setup +
              (plot.empty() ? "unset label\nset multiplot next\n" : plot + "\n");
  };
  panel("D, distribution of facets",
        "set xlabel 'θ_h [°], spaced by its root'\nset ylabel 'D [1/sr]'\n"
        "set xrange [0:sqrt(90)]\n"
        "set xtics ('0' 0, '1' 1, '5' sqrt(5), '15' sqrt(15), '30' sqrt(30), '60' sqrt(60), "
        "'90' sqrt(90))\n",
        CurvesPanel(file, light, Factor::kD, roots, true));
  panel("F, Fresnel factor",
        "set xrange [0:90]\nset xtics 0,15,90\nset xlabel 'θ_d [°]'\nset ylabel 'F, mean 1'\n",
        CurvesPanel(file, light, Factor::kF, degrees(Factor::kF), false));
  panel("G, shadowing and masking", "set xlabel 'θ_i, θ_o [°]'\nset ylabel 'G, mean 1'\n",
        CurvesPanel(file, light, Factor::kG, degrees(Factor::kG), false));
  panel("albedo, and share of all that is reflected",
        "set xlabel ''\nset ylabel ''\nunset grid\nset grid ytics\n", AlbedoPanel(light));
  DrawPng(path, 1800, 1300, script);
}

}  // namespace trilobe
