#include "io/pictures/plot_factors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/file_names.h"
#include "io/pictures/gnuplot.h"
#include "io/pictures/plots.h"
#include "model/objective/gauge.h"
#include "trilobe/model/objective/lobe_light.h"

namespace trilobe {
namespace {

// --- Panels --------------------------------------------------------------------------------------

// In pixels.
constexpr int kLeft = 150, kRight = 45;    // of a panel's axes: room for labels and tics
constexpr int kAbove = 130, kBelow = 110;  // for title and legend, for labels
constexpr int kPanelHeight = 340;

std::string Fraction(double a, int b) { return GnuplotNumber(a / b); }

}  // namespace

std::string PanelMargins(int x, int y, int width, int height, int canvas_width, int canvas_height) {
  return "set lmargin at screen " + Fraction(x, canvas_width) + "\nset rmargin at screen " +
         Fraction(x + width, canvas_width) + "\nset tmargin at screen " +
         Fraction(canvas_height - y, canvas_height) + "\nset bmargin at screen " +
         Fraction(canvas_height - y - height, canvas_height) + "\n";
}

void PanelRows::Add(std::vector<Panel> panels, int columns) {
  std::erase_if(panels, [](const Panel& panel) { return panel.plot.empty(); });
  for (size_t k = 0; k < panels.size(); ++k) {
    if (k % columns == 0) rows_.emplace_back();
    rows_.back().push_back(std::move(panels[k]));
  }
}

int PanelRows::height() const {
  return static_cast<int>(rows_.size()) * (kAbove + kPanelHeight + kBelow);
}

std::string PanelRows::Script(int top, int canvas) const {
  std::string script;
  for (const std::vector<Panel>& row : rows_) {
    const int cell = width_ / static_cast<int>(row.size());
    for (size_t k = 0; k < row.size(); ++k) {
      const Panel& panel = row[k];
      const int x = static_cast<int>(k) * cell + kLeft, width = cell - kLeft - kRight;
      const std::string center = " at screen " + Fraction(x + width / 2.0, width_) + ", screen ";
      script += PanelMargins(x, top + kAbove, width, kPanelHeight, width_, canvas) +
                "set border 3 linecolor '#555555'\nset tics nomirror out\n"
                "set grid xtics ytics\nset xtics nomirror out autofreq\n"
                "set ytics nomirror out autofreq\n"
                "set label 1 '" +
                panel.title + "'" + center + Fraction(canvas - top - 34, canvas) +
                " center font ',19'\nset key" + center + Fraction(canvas - top - 50, canvas) +
                " center top horizontal maxrows 2 width 0 font ',15'\n" + panel.setup + panel.plot +
                "\nunset label\n";
    }
    top += kAbove + kPanelHeight + kBelow;
  }
  return script;
}

// --- Contents ------------------------------------------------------------------------------------

namespace {

// End entries of a table that carry together less than this share of its light are dotted, as they
// may be anything.
constexpr double kHardlyAny = 2e-3;

// Titles and setups of the panels of D, F and G.
constexpr const char* kPanelTitles[] = {"D, distribution of facets", "F, Fresnel factor",
                                        "G, shadowing and masking"};
constexpr const char* kPanelSetups[] = {
    ("set xlabel 'θ_h [°], spaced by its root'\nset ylabel 'D [1/sr]'\nset xrange [0:sqrt(90)]\n"
     "set xtics ('0' 0, '1' 1, '5' sqrt(5), '15' sqrt(15), '30' sqrt(30), '60' sqrt(60), "
     "'90' sqrt(90))\n"),
    "set xrange [0:90]\nset xtics 0,15,90\nset xlabel 'θ_d [°]'\nset ylabel 'F, mean 1'\n",
    ("set xrange [0:90]\nset xtics 0,15,90\nset xlabel 'θ_i, θ_o [°]'\n"
     "set ylabel 'G, mean 1'\n")};

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

// "62 %", "<0.1 %", for gnuplot, which takes the labels of tics for formats.
std::string Percent(double share) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), share >= 0.0995 ? "%.0f" : "%.1f", 100 * share);
  return (share > 0 && share < 0.0005 ? "<0.1" : std::string(text.data())) + " %%";
}

std::string LobeName(const LobeLight& light, int lobe) {
  return "lobe " + std::to_string(lobe + 1) +
         (light.nearly_diffuse[lobe] ? " (nearly diffuse)" : "");
}

// Text behind the name of a lobe that is dark.
const char* AbsenceOf(const FactorModel& model, int lobe) {
  return ReflectsNothing(model, lobe) ? " (s = 0)" : "";
}

// Whether entries matter: they are observed, and light goes through them. Entries of D near theta_h
// = 0 get little light, as they are few directions, but are what is seen of a highlight.
std::vector<bool> EntriesThatMatter(const ModelFile& file, const LobeLight& light, Factor factor,
                                    int index) {
  const int size = file.model.spec().table_size(factor);
  const size_t offset = file.model.TableOffset(factor, index);
  const auto through = std::span(light.through).subspan(offset, size);
  const double hardly_any = kHardlyAny * std::accumulate(through.begin(), through.end(), 0.0);
  std::vector<bool> matters(size);
  for (int i = 0; i < size; ++i) matters[i] = !file.unobserved[offset + i];
  double sum = 0;
  for (int i = size - 1; i >= 0 && (sum += through[i]) <= hardly_any; --i) matters[i] = false;
  sum = 0;
  for (int i = 0; i < size && factor != Factor::kD && (sum += through[i]) <= hardly_any; ++i) {
    matters[i] = false;
  }
  return matters;
}

}  // namespace

bool ReflectsNothing(const FactorModel& model, int lobe) {
  return std::ranges::all_of(model.s(lobe), [](double s) { return s == 0; });
}

TableOwner OwnerOf(const ModelSpec& spec, Factor factor, int index) {
  const TableSharing& sharing = spec.sharing(factor);
  const int channels = sharing.per_channel ? kChannels : 1;
  return {sharing.per_lobe ? index / channels : 0, sharing.per_channel ? index % channels : 0};
}

std::string TableName(const FactorModel& model, const LobeLight& light, Factor factor, int index) {
  const ModelSpec& spec = model.spec();
  const TableSharing& sharing = spec.sharing(factor);
  const auto [lobe, channel] = OwnerOf(spec, factor, index);
  std::string name;
  if (sharing.per_lobe && (spec.lobes > 1 || !sharing.per_channel)) name = LobeName(light, lobe);
  if (sharing.per_channel) name += (name.empty() ? "" : ", ") + std::string(kChannelNames[channel]);
  if (name.empty()) name = "all lobes";
  return sharing.per_lobe ? name + AbsenceOf(model, lobe) : name;
}

namespace {

// The plot command of these tables, and their data.
std::string Curves(const ModelFile& file, const LobeLight& light, Factor factor,
                   const std::vector<int>& tables) {
  const ModelSpec& spec = file.model.spec();
  std::vector<double> values;
  std::vector<std::vector<bool>> matters;
  for (const int t : tables) {
    const std::span<const double> table = file.model.table(factor, t);
    matters.push_back(EntriesThatMatter(file, light, factor, t));
    for (size_t i = 0; i < table.size(); ++i) {
      if (matters.back()[i]) values.push_back(table[i]);
    }
  }
  if (values.empty()) return "";
  // Linear as in the paper, unless a peak would flatten all the rest.
  std::vector<double> sorted = values;
  std::ranges::sort(sorted);
  const double top = sorted.back(), median = sorted[sorted.size() / 2];
  const bool logarithmic = top > 0 && (factor == Factor::kD || top > 10 * median);
  const AxisRange range = logarithmic ? LogRange(values, factor == Factor::kD ? 6 : 5)
                                      : AxisRange{0, top > 0 ? 1.08 * top : 1};
  double beyond = 0;  // the largest above the axis
  std::string data, plot;
  bool any_dotted = false;
  size_t longest = 0;  // name in the legend
  for (size_t k = 0; k < tables.size(); ++k) {
    const int t = tables[k];
    const std::span<const double> table = file.model.table(factor, t);
    const int size = static_cast<int>(table.size());
    std::vector<std::vector<double>> rows;  // abscissa, value, value where it does not matter
    for (int i = 0; i < size; ++i) {
      const double degrees = RadiansToDegrees(spec.axis(factor).Theta(i));
      // Values below the axis run along it, values above it are left out.
      if (table[i] > range.high) beyond = std::max(beyond, table[i]);
      const double value = table[i] > range.high ? kGap : std::max(table[i], range.low);
      const bool dotted =
          !matters[k][i] || (i > 0 && !matters[k][i - 1]) || (i + 1 < size && !matters[k][i + 1]);
      any_dotted = any_dotted || dotted;
      rows.push_back({factor == Factor::kD ? std::sqrt(degrees) : degrees,
                      matters[k][i] ? value : kGap, dotted ? value : kGap});
    }
    const std::string block = std::string(FactorName(factor)) + std::to_string(t);
    data += GnuplotData(block, rows);
    const auto [lobe, channel] = OwnerOf(spec, factor, t);
    const std::string color =
        spec.sharing(factor).per_channel ? kChannelColors[channel] : kLobeColors[lobe];
    const bool named_by_panel = tables.size() <= kChannels && spec.sharing(factor).per_channel;
    const std::string name =
        named_by_panel ? kChannelNames[channel] : TableName(file.model, light, factor, t);
    longest = std::max(longest, name.size());
    plot += (k == 0 ? "plot $" : ", $") + block +
            " using 1:2 with lines linewidth 2.5 linecolor '" + color + "' title '" + name +
            "', '' " + "using 1:3 with lines linewidth 2 dashtype (2,3) linecolor '" + color +
            "' notitle";
  }
  if (any_dotted) {
    std::array<char, 64> name{};
    std::snprintf(name.data(), name.size(),
                  beyond > 0 ? "no data or light, up to %.2g" : "no data or light", beyond);
    longest = std::max(longest, std::string_view(name.data()).size());
    plot += std::string(", NaN with lines linewidth 2 dashtype (2,3) linecolor '#555555' title '") +
            name.data() + "'";
  }
  // gnuplot takes letters for wider than they are, and would set long names in one column.
  return data + (longest > 20 ? "set key width -5\n" : "") +
         (logarithmic ? "set logscale y\n" + LogTics(range, 'y')
                      : std::string("unset logscale y\nset format y '%g'\n")) +
         "set yrange [" + GnuplotNumber(range.low) + ":" + GnuplotNumber(range.high) + "]\n" + plot;
}

}  // namespace

std::vector<Panel> CurvePanels(const ModelFile& file, const LobeLight& light, Factor factor) {
  const std::string title = kPanelTitles[static_cast<int>(factor)];
  const ModelSpec& spec = file.model.spec();
  const TableSharing& sharing = spec.sharing(factor);
  std::vector<Panel> panels;
  // Many curves get as many panels as there are lobes.
  const bool by_lobe = sharing.per_lobe && sharing.per_channel && spec.lobes > 1;
  for (int m = 0; m < (by_lobe ? spec.lobes : 1); ++m) {
    std::vector<int> tables;
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const int lobe = OwnerOf(spec, factor, t).lobe;
      if ((!by_lobe || lobe == m) && !(sharing.per_lobe && ReflectsNothing(file.model, lobe))) {
        tables.push_back(t);
      }
    }
    panels.push_back({title + (by_lobe ? ", " + LobeName(light, m) : ""),
                      kPanelSetups[static_cast<int>(factor)], Curves(file, light, factor, tables)});
  }
  return panels;
}

Panel AlbedoPanel(const LobeLight& light) {
  const int groups = 1 + static_cast<int>(light.lobes.size());
  std::string data[kChannels], tics;
  double top = 0;
  for (int g = 0; g < groups; ++g) {
    const Rgb& values = g == 0 ? light.diffuse : light.lobes[g - 1];
    for (int c = 0; c < kChannels; ++c) {
      data[c] += GnuplotNumber(g + 0.28 * (c - 1)) + " " + GnuplotNumber(values[c]) + "\n";
      top = std::max(top, values[c]);
    }
    const std::string name = g == 0 ? "diffuse" : "lobe " + std::to_string(g);
    const double share = g == 0 ? light.DiffuseShare() : light.Share(g - 1);
    tics += (g == 0 ? "\"" : ", \"") + name + "\\n" + Percent(share) +
            (g > 0 && light.nearly_diffuse[g - 1] ? "\\nnearly diffuse" : "") + "\" " +
            std::to_string(g);
  }
  std::string script, plot;
  const std::string font = groups <= 4 ? ",14" : ",11";
  const std::string tic_font = groups <= 6 ? "" : " font ',12'";
  for (int c = 0; c < kChannels; ++c) {
    const std::string block = "$coefficient" + std::to_string(c);
    script += block + " << EOD\n" + data[c] + "EOD\n";
    plot += (c == 0 ? "plot " : ", ") + block + " using 1:2 with boxes linecolor '" +
            kChannelColors[c] + "' title '" + kChannelNames[c] + "', '' using 1:2:" +
            "($2 >= 0.0005 ? sprintf('%.3g', $2) : $2 > 0 ? '<0.0005' : '0') with labels rotate by "
            "90 left offset 0,0.4 font '" +
            font + "' notitle";
  }
  return {.title = "albedo, and share of all that is reflected",
          .setup = script + "unset logscale y\nset format y '%g'\nset yrange [0:" +
                   GnuplotNumber(top > 0 ? 1.35 * top : 1) + "]\nset xrange [-0.6:" +
                   GnuplotNumber(groups - 0.4) + "]\nset xtics (" + tics + ")" + tic_font +
                   "\nset boxwidth 0.26\nset style fill solid 0.85 noborder\nset xlabel ''\n"
                   "set ylabel ''\nunset grid\nset grid ytics\n",
          .plot = plot};
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
  constexpr int kWidth = 1800, kTop = 70;
  PanelRows rows(kWidth);
  std::vector<Panel> single;  // those of one panel share rows
  for (const Factor factor : kFactors) {
    std::vector<Panel> panels = CurvePanels(file, light, factor);
    if (panels.size() == 1) {
      single.push_back(std::move(panels[0]));
    } else {
      rows.Add(std::move(panels), spec.lobes == 3 ? 3 : 2);
    }
  }
  single.push_back(AlbedoPanel(light));
  rows.Add(std::move(single), 2);
  const int height = kTop + rows.height();
  DrawPng(path, kWidth, height,
          "set multiplot\nset label 99 " +
              GnuplotTitle("Factors: " + FileNameOf(name), kWidth, 22) + " at screen 0.5, screen " +
              GnuplotNumber(1 - 36.0 / height) + " center\n" + rows.Script(kTop, height));
}

}  // namespace trilobe
