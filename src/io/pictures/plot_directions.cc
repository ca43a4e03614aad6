#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "core/base/file_names.h"
#include "io/pictures/gnuplot.h"
#include "io/pictures/plots.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/channels.h"

namespace trilobe {
namespace {

constexpr int kColumns = 3, kMostPanels = 9, kMostPoints = 4000;  // of a panel
constexpr int kPanel = 420, kWidth = kColumns * kPanel, kTop = 60, kBottom = 140;

// Samples of about one theta_i.
struct Incidence {
  double theta_i_deg = 0;
  int samples = 0;
  std::vector<std::vector<double>> points;  // x, y [degrees], value; NaN for 0
};

// Position as seen along the normal, light from the left, its mirror direction to the right.
std::vector<double> PointOf(const SphericalAngles& at, double rho) {
  const double azimuth = std::remainder(at.phi_o - at.phi_i, 2 * kPi);
  const double theta_o = RadiansToDegrees(at.theta_o);
  return {-theta_o * std::cos(azimuth), theta_o * std::sin(azimuth),
          rho > 0 ? rho : std::numeric_limits<double>::quiet_NaN()};
}

std::vector<Incidence> IncidencesOf(const BrdfSamples& samples) {
  constexpr double kStep = 5;
  std::map<int, std::vector<int>> steps;
  for (int j = 0; j < samples.size(); ++j) {
    steps[static_cast<int>(RadiansToDegrees(samples.directions[j].theta_i) / kStep)].push_back(j);
  }
  std::vector<std::vector<int>> all;
  for (auto& [step, numbers] : steps) all.push_back(std::move(numbers));
  std::vector<Incidence> incidences;
  const size_t shown = std::min<size_t>(all.size(), kMostPanels);
  for (size_t k = 0; k < shown; ++k) {
    const std::vector<int>& numbers = all[shown < 2 ? 0 : k * (all.size() - 1) / (shown - 1)];
    Incidence& incidence = incidences.emplace_back();
    incidence.samples = static_cast<int>(numbers.size());
    for (const int j : numbers) {
      incidence.theta_i_deg +=
          RadiansToDegrees(samples.directions[j].theta_i) / static_cast<double>(numbers.size());
    }
    const size_t stride = 1 + numbers.size() / kMostPoints;
    for (size_t n = 0; n < numbers.size(); n += stride) {
      const int j = numbers[n];
      incidence.points.push_back(PointOf(samples.directions[j], Mean(samples.rho[j])));
    }
    // The brightest last, so that they are seen.
    std::ranges::stable_sort(incidence.points, [](const auto& a, const auto& b) {
      return (std::isnan(a[2]) ? 0 : a[2]) < (std::isnan(b[2]) ? 0 : b[2]);
    });
  }
  return incidences;
}

std::string Circles() {
  std::string text;
  for (const int theta : {30, 60, 90}) {
    text += "set object " + std::to_string(theta) + " circle at 0,0 size " + std::to_string(theta) +
            " back fillstyle empty border linecolor '#C0C0C0'\n";
  }
  return text;
}

}  // namespace

void DrawDirections(const Measurement& scattered, const std::string& path) {
  const std::vector<Incidence> incidences = IncidencesOf(scattered.samples);
  std::vector<double> values;
  for (const Incidence& incidence : incidences) {
    for (const std::vector<double>& point : incidence.points) {
      if (point[2] > 0) values.push_back(point[2]);
    }
  }
  constexpr double kDecades = 4;
  const AxisRange range = LogRange(values, kDecades);
  const int panels = static_cast<int>(incidences.size());
  const int rows = (panels + kColumns - 1) / kColumns, height = kTop + kBottom + rows * kPanel;
  std::string script;
  for (int k = 0; k < panels; ++k) {
    script += GnuplotData("at" + std::to_string(k), incidences[k].points);
  }
  script +=
      "set multiplot\nunset key\nunset border\nunset tics\nunset grid\nset size ratio -1\n"
      "set xrange [-94:94]\nset yrange [-94:94]\nset logscale cb\n"
      "set palette defined (0 '#0B2A52', 0.35 '#2F6FA8', 0.65 '#8FBBDA', 0.85 '#F2A65A', 1 "
      "'#D7301F')\nset cbrange [" +
      GnuplotNumber(range.low) + ":" + GnuplotNumber(range.high) + "]\nunset colorbox\n" +
      Circles();
  for (int k = 0; k < panels; ++k) {
    const Incidence& incidence = incidences[k];
    const auto share = [](double part, double whole) { return GnuplotNumber(part / whole); };
    const int row = k / kColumns, column = k % kColumns;
    const double left = column * kPanel + 20, top = kTop + row * kPanel + 40;
    script += "set lmargin at screen " + share(left, kWidth) + "\nset rmargin at screen " +
              share(left + kPanel - 40, kWidth) + "\nset tmargin at screen " +
              share(height - top, height) + "\nset bmargin at screen " +
              share(height - top - kPanel + 40, height) + "\n" +
              "set title sprintf('θ_i = %.3g°, %d samples', " +
              GnuplotNumber(incidence.theta_i_deg) + ", " + std::to_string(incidence.samples) +
              ") font ',17' offset 0,-0.4\n";
    if (k == 0) {
      script +=
          "set label 1 '30°' at 21,21 textcolor '#808080' font ',12'\n"
          "set label 2 '60°' at 43,43 textcolor '#808080' font ',12'\n"
          "set label 3 'θ_o = 90°' at 64,66 textcolor '#808080' font ',12'\n";
    } else {
      script += "unset label\n";
    }
    if (k + 1 == panels) {
      script += "set colorbox user horizontal origin 0.25," + share(110, height) + " size 0.5," +
                share(16, height) +
                "\nset cbtics\nset format cb '10^{%T}'\nset cblabel 'ρ, mean of the channels "
                "[1/sr]; crosses "
                "are 0; + the light, ○ its mirror direction' font ',15'\n";
    }
    const std::string block = "$at" + std::to_string(k), at = GnuplotNumber(incidence.theta_i_deg);
    script += "plot " + block +
              " using 1:2:3 with points pointtype 7 pointsize 0.8 linecolor palette, " + block +
              " using (valid(3) ? NaN : $1):2 with points pointtype 2 pointsize 0.7 linecolor "
              "'#000000', '+' using (-" +
              at +
              "):(0) every ::::0 with points pointtype 1 pointsize 1.6 linewidth 2 linecolor "
              "'#000000', '+' using (" +
              at +
              "):(0) every ::::0 with points pointtype 6 pointsize 1.6 linewidth 2 linecolor "
              "'#000000'\n";
  }
  script += "unset multiplot\n";
  script =
      "set label 99 " +
      GnuplotQuote("Where " + FileNameOf(scattered.source) + " was measured, light from the left") +
      " noenhanced at screen 0.5," + GnuplotNumber(1 - 30.0 / height) + " center font ',22'\n" +
      script;
  DrawPng(path, kWidth, height, script);
}

}  // namespace trilobe
