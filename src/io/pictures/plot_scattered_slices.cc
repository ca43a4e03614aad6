#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include "io/pictures/gnuplot.h"
#include "io/pictures/plots.h"

namespace trilobe {
namespace {

// Dark to light, apart in brightness as well as in hue.
constexpr const char* kColors[] = {"#000000", "#0072B2", "#009E73", "#D55E00", "#E69F00"};
constexpr size_t kCurves = std::size(kColors);
constexpr int kSteps = 356;                          // of a fitted line
constexpr double kOffPlane = 2.5, kOffTheta = 1.25;  // [degrees] of samples that are shown
constexpr int kFewest = 8;                           // samples of a curve

struct InPlane {
  double theta_i, phi_i;
  double theta_o;  // below 0 on the light's side
  Rgb rho;
};

// The samples whose theta_o, signed, is in the plane of incidence or almost so; in degrees.
std::vector<InPlane> InPlaneSamples(const BrdfSamples& samples) {
  std::vector<InPlane> found;
  for (size_t j = 0; j < samples.directions.size(); ++j) {
    const SphericalAngles& at = samples.directions[j];
    const double turn = at.phi_o - at.phi_i;
    const double off = RadiansToDegrees(std::asin(std::abs(std::sin(turn))));
    // The azimuth of the normal is any.
    if (off > kOffPlane && RadiansToDegrees(std::min(at.theta_o, at.theta_i)) > 1e-6) continue;
    found.push_back({RadiansToDegrees(at.theta_i),
                     RadiansToDegrees(std::remainder(at.phi_i, 2 * kPi)),
                     RadiansToDegrees(at.theta_o) * (std::cos(turn) < 0 ? 1 : -1), samples.rho[j]});
  }
  return found;
}

// The azimuth of most of them, where azimuths matter; the others are taken out.
double KeepOneAzimuth(std::vector<InPlane>* samples) {
  std::vector<double> azimuths;
  for (const InPlane& sample : *samples) azimuths.push_back(sample.phi_i);
  std::ranges::sort(azimuths);
  double best = 0;
  std::ptrdiff_t most = 0;
  for (auto first = azimuths.begin(); first != azimuths.end(); ++first) {
    const auto count = std::upper_bound(first, azimuths.end(), *first + kOffPlane) - first;
    if (count > most) {
      most = count;
      best = *first;
    }
  }
  std::erase_if(*samples, [&](const InPlane& sample) {
    return sample.phi_i < best || sample.phi_i > best + kOffPlane;
  });
  return best;
}

// A few theta_i with samples enough, evenly among all of them.
std::vector<double> ThetasOf(const std::vector<InPlane>& samples) {
  std::vector<double> thetas, enough;
  for (const InPlane& sample : samples) thetas.push_back(sample.theta_i);
  std::ranges::sort(thetas);
  for (size_t k = 0; k < thetas.size();) {
    size_t end = k;
    while (end < thetas.size() && thetas[end] <= thetas[k] + kOffTheta) ++end;
    if (end - k >= kFewest) enough.push_back(thetas[k]);
    k = end;
  }
  std::vector<double> chosen;
  const size_t curves = std::min(kCurves, enough.size());
  for (size_t k = 0; k < curves; ++k) {
    chosen.push_back(enough[(2 * k + 1) * enough.size() / (2 * curves)]);
  }
  return chosen;
}

// The samples of slices, in the plane of incidence, and where that is.
struct Slices {
  std::vector<InPlane> samples;
  double phi_i = 0;  // [degrees]
  std::vector<double> thetas;
};
Slices SlicesOf(const Measurement& scattered) {
  Slices slices{.samples = InPlaneSamples(scattered.samples), .thetas = {}};
  if (scattered.anisotropic) slices.phi_i = KeepOneAzimuth(&slices.samples);
  slices.thetas = ThetasOf(slices.samples);
  return slices;
}

}  // namespace

bool HasSlices(const Measurement& scattered) { return !SlicesOf(scattered).thetas.empty(); }

void DrawSlices(const Measurement& scattered, const SphericalBrdf& fitted,
                const std::string& path) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  constexpr int kWidth = 2000;
  const auto& [samples, phi_i, thetas] = SlicesOf(scattered);
  std::string script;
  std::vector<double> values;
  for (size_t k = 0; k < thetas.size(); ++k) {
    std::vector<std::vector<double>> points, lines;  // theta_o, then the channels
    for (const InPlane& sample : samples) {
      if (sample.theta_i < thetas[k] || sample.theta_i > thetas[k] + kOffTheta) continue;
      std::vector<double>& row = points.emplace_back(1, sample.theta_o);
      for (const double x : sample.rho) {
        row.push_back(x > 0 ? x : kNone);
        values.push_back(x);
      }
    }
    const double last = RadiansToDegrees(scattered.max_theta);
    for (int step = 0; step <= kSteps; ++step) {
      const double theta_o = last * (2.0 * step / kSteps - 1);
      const double along = DegreesToRadians(phi_i);
      const double theta = std::min(DegreesToRadians(std::abs(theta_o)), kPi / 2 - 1e-3);
      const Rgb rho =
          fitted({DegreesToRadians(thetas[k]), along, theta, theta_o >= 0 ? along + kPi : along});
      std::vector<double>& row = lines.emplace_back(1, theta_o);
      for (const double x : rho) row.push_back(x > 0 ? x : kNone);
    }
    script += GnuplotData("points" + std::to_string(k), points) +
              GnuplotData("lines" + std::to_string(k), lines);
  }
  const AxisRange range = LogRange(values, 5);
  script += "set multiplot title " +
            GnuplotTitle("Measured (points) and fitted (lines): " + PictureName(scattered.source),
                         kWidth, 22) +
            "\nset logscale y\nset xrange [-90:90]\nset xtics -90,30,90\nset yrange [" +
            GnuplotNumber(range.low) + ":" + GnuplotNumber(range.high) +
            "]\nset xlabel 'θ_o [°] in plane, light at < 0'\n"
            "set tmargin at screen 0.865\nset bmargin at screen 0.125\n";
  for (int c = 0; c < kChannels; ++c) {
    const double left = 0.085 + 0.27 * c;
    script += "set lmargin at screen " + GnuplotNumber(left) + "\nset rmargin at screen " +
              GnuplotNumber(left + 0.245) + "\nset title '" + kChannelNames[c] +
              "' offset 0,-0.4\n" + LogTics(range, 'y');
    script += c == 0 ? "set ylabel 'BRDF [1/sr]'\n" : "unset ylabel\nset format y ''\n";
    script +=
        c == 2 ? "set key at screen 0.995, screen 0.52 right center vertical spacing 1.5 enhanced\n"
               : "unset key\n";
    for (size_t k = 0; k < thetas.size(); ++k) {
      const std::string block = std::to_string(k), column = std::to_string(2 + c);
      script += (k == 0 ? "plot $points" : ", $points") + block + " using 1:" + column +
                " with points pointtype 7 pointsize 0.9 linecolor '" + kColors[k] +
                "' notitle, $lines" + block + " using 1:" + column +
                " with lines linewidth 2.2 linecolor '" + kColors[k] +
                "' title 'θ_i = " + GnuplotNumber(std::round(10 * thetas[k]) / 10) + "°'";
    }
    script += '\n';
  }
  DrawPng(path, kWidth, 1000, script);
}

}  // namespace trilobe
