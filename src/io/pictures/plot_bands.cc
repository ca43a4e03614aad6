#include <algorithm>
#include <string>
#include <vector>

#include "io/pictures/gnuplot.h"
#include "io/pictures/plots.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/objective/lobe_light.h"

namespace trilobe {
namespace {

// [bands][wavelength, relative error in %, albedo of the diffuse term and of each lobe].
std::vector<std::vector<double>> RowsOf(const SpectralModel& model,
                                        std::span<const double> relative_error) {
  const std::vector<double> covered(model.shared().parameters().size(), 1);
  std::vector<std::vector<double>> rows;
  for (int first = 0; first < model.bands(); first += kChannels) {
    const LobeLight light = ComputeLobeLight(covered, model.ThreeBands(first));
    for (int c = 0; c < std::min(kChannels, model.bands() - first); ++c) {
      rows.push_back(
          {model.wavelengths()[first + c], 100 * relative_error[first + c], light.diffuse[c]});
      for (const Rgb& albedo : light.lobes) rows.back().push_back(albedo[c]);
    }
  }
  return rows;
}

// [entries][theta_d in degrees, F of each band].
std::vector<std::vector<double>> FresnelRows(const SpectralModel& model) {
  std::vector<std::vector<double>> rows;
  const Axis& axis = model.spec().f_axis;
  for (int k = 0; k < axis.size; ++k) {
    rows.push_back({RadiansToDegrees(axis.Theta(k))});
    for (int l = 0; l < model.bands(); ++l) rows.back().push_back(model.F(0, l)[k]);
  }
  return rows;
}

std::string Curve(int column, const std::string& color, const std::string& title) {
  return "'' using 1:" + std::to_string(column) +
         " with linespoints pointtype 7 pointsize 0.8 linewidth 2.5 linecolor '" + color +
         "' title '" + title + "'";
}

}  // namespace

void DrawBands(const SpectralModel& model, std::span<const double> relative_error,
               const std::string& title, const std::string& path) {
  if (static_cast<int>(relative_error.size()) != model.bands()) {
    throw Error(ErrorKind::kMismatch,
                "a spectral model is drawn with the error of each of its wavelengths")
        .About("relative_error", relative_error.size());
  }
  const int lobes = model.spec().lobes;
  const double first = model.wavelengths().front(), last = model.wavelengths().back();
  const double margin = first < last ? 0 : 5;  // [nm]
  const bool has_F = lobes > 0;
  std::string script = GnuplotData("bands", RowsOf(model, relative_error));
  if (has_F) script += GnuplotData("fresnel", FresnelRows(model));
  script += "set multiplot layout 1," + std::to_string(has_F ? 3 : 2) + " title " +
            GnuplotTitle(title, 1800, 22) + "\nset lmargin 13\nset rmargin 2\nset xrange [" +
            GnuplotNumber(first - margin) + ":" + GnuplotNumber(last + margin) +
            "]\nset yrange [0:*]\nset format y '%g'\nset key above horizontal\nset tmargin 5\nset "
            "bmargin 4\n"
            "set xlabel 'wavelength [nm]'\nset ylabel 'E [% of a black model]'\n"
            "plot $bands using 1:2 with linespoints pointtype 7 pointsize 0.9 linewidth 2.5 "
            "linecolor '" +
            kOkabeIto[4] +
            "' notitle\nset ylabel 'albedo'\nplot $bands using 1:3 with "
            "linespoints pointtype 7 pointsize 0.8 linewidth 2.5 linecolor 'black' title 'diffuse'";
  for (int m = 0; m < lobes; ++m) {
    script += ", " + Curve(4 + m, kLobeColors[m], "lobe " + std::to_string(m + 1));
  }
  script += "\n";
  if (has_F) {
    script += "set xlabel 'θ_d [deg]'\nset xrange [0:90]\nset xtics 30\nset ylabel 'F" +
              std::string(model.spec().F.per_lobe ? " of lobe 1" : "") +
              "'\nset cblabel 'wavelength [nm]' offset 1.5\nset cbrange [" +
              GnuplotNumber(first - margin) + ":" + GnuplotNumber(last + margin) +
              "]\nset palette defined (0 '#440154', 0.25 '#3b528b', 0.5 '#21918c', "
              "0.75 '#5ec962', 1 '#fde725')\nset lmargin 7\nset rmargin 11\nplot ";
    for (int l = 0; l < model.bands(); ++l) {
      script += (l > 0 ? ", " : "") + std::string("$fresnel using 1:") + std::to_string(2 + l) +
                ":(" + GnuplotNumber(model.wavelengths()[l]) +
                ") with lines linewidth 2 linecolor palette notitle";
    }
    script += "\n";
  }
  DrawPng(path, 1800, 620, script);
}

}  // namespace trilobe
