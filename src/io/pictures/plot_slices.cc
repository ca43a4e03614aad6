#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include "core/base/file_names.h"
#include "io/pictures/gnuplot.h"
#include "io/pictures/plots.h"
#include "model/appearance/hardly_seen.h"

namespace trilobe {
namespace {

// Dark to light, apart in brightness as well as in hue.
constexpr const char* kColors[] = {"#000000", "#0072B2", "#009E73", "#D55E00", "#E69F00"};
constexpr int kCurves = std::size(kColors);
constexpr int kWidth = 2000;  // pixels
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// --- Tables --------------------------------------------------------------------------------------

constexpr double kThetaD[kCurves] = {5, 25, 45, 65, 80};  // degrees; the bins that begin there

// Style of a bin: of most bins, of one that is hardly seen, of one without measured value.
enum Way : uint8_t { kPlain, kPale, kDotted, kWays };
constexpr int kColumns = 2 * kWays;  // of a theta_d: the measured value in its way, the fitted one

// Slices through all bins of theta_h, at each kThetaD and the middle of phi_d.
class TableSlices {
 public:
  TableSlices(const BrdfTable& measured, const BrdfTable& fitted)
      : measured_(measured),
        fitted_(fitted),
        valid_(ValidBins(measured)),
        drawable_(ValidBins(fitted)) {
    const MerlGrid& grid = measured.grid;
    const std::vector<bool> hardly_seen = HardlySeen(measured, fitted);
    ways_.resize(grid.theta_h * kCurves, kDotted);
    for (int k = 0; k < kCurves; ++k) {
      // A bin that was left out between others is drawn as these are.
      int first = 0, end = grid.theta_h;
      while (first < end && !valid_[BinOf(first, k)]) ++first;
      while (first < end && !valid_[BinOf(end - 1, k)]) --end;
      for (int h = first; h < end; ++h) {
        const bool pale = hardly_seen[BinOf(h, k) / grid.phi_d];
        ways_[h * kCurves + k] = pale ? kPale : kPlain;
        any_pale_ = any_pale_ || pale;
      }
      for (int h = 0; h < grid.theta_h; ++h) {
        any_dotted_ = any_dotted_ || (WayOf(h, k) == kDotted && drawable_[BinOf(h, k)]);
      }
    }
  }

  // sqrt(theta_h), then kColumns for each theta_d. Adds to `values` what the axis has to show:
  // where nothing was measured, the fit may be anything.
  std::vector<std::vector<double>> Rows(int channel, std::vector<double>* values) const {
    const MerlGrid& grid = measured_.grid;
    std::vector<std::vector<double>> rows;
    for (int h = 0; h < grid.theta_h; ++h) {
      std::vector<double>& row = rows.emplace_back(1 + kCurves * kColumns, kNone);
      row[0] = std::sqrt(RadiansToDegrees(grid.ThetaH(h + 0.5)));
      for (int k = 0; k < kCurves; ++k) {
        const int bin = BinOf(h, k);
        const Way way = WayOf(h, k);
        const double point = valid_[bin] ? measured_.Value(channel, bin) : 0;
        const double line = drawable_[bin] ? fitted_.Value(channel, bin) : 0;
        double* const at = &row[1 + k * kColumns];
        if (point > 0) at[way] = point;
        // A line goes on to where it is drawn in a fainter way.
        for (int beside = std::max(h - 1, 0); beside <= std::min(h + 1, grid.theta_h - 1);
             ++beside) {
          if (line > 0 && WayOf(beside, k) >= way) at[kWays + WayOf(beside, k)] = line;
        }
        if (valid_[bin]) values->insert(values->end(), {point, line});
      }
    }
    return rows;
  }

  // Text below the panels.
  std::string Note() const {
    std::string note;
    if (any_pale_) {
      note = "pale: together less than " + GnuplotNumber(100 * kHardlySeen) +
             " % of the light of an evenly lit sphere, so what differs there is hardly seen";
    }
    if (any_dotted_) note += std::string(any_pale_ ? ";  " : "") + "dotted: not measured";
    return note;
  }

 private:
  int BinOf(int h, int k) const {
    const MerlGrid& grid = measured_.grid;
    return grid.Index(h, static_cast<int>(kThetaD[k] / 90 * grid.theta_d), grid.phi_d / 2);
  }
  Way WayOf(int h, int k) const { return ways_[h * kCurves + k]; }

  const BrdfTable &measured_, &fitted_;
  const std::vector<bool> valid_, drawable_;  // whether there is a value, by bin
  std::vector<Way> ways_;                     // [theta_h * kCurves]
  bool any_pale_ = false, any_dotted_ = false;
};

// "#B0D55E00": mostly transparent.
std::string Faint(const char* color) { return std::string("#B0") + (color + 1); }

}  // namespace

void DrawSlices(const BrdfTable& measured, const BrdfTable& fitted, const std::string& path) {
  const MerlGrid& grid = measured.grid;
  const TableSlices slices(measured, fitted);
  std::string data;
  std::vector<double> values;
  for (int c = 0; c < kChannels; ++c) {
    data += GnuplotData("channel" + std::to_string(c), slices.Rows(c, &values));
  }

  std::string script = data;
  script += "set multiplot title " +
            GnuplotTitle("Measured (points) and fitted (lines): " + FileNameOf(measured.source),
                         2000, 22) +
            "\n"
            "set logscale y\n"
            "set format y '10^{%T}'\n"
            "set xrange [0:sqrt(90)]\n"
            "set yrange " +
            GnuplotLogRange(values, 9) +
            "\nset xtics ('0' 0, '1' 1, '5' sqrt(5), '15' sqrt(15), '30' sqrt(30), "
            "'60' sqrt(60), '90' sqrt(90))\n"
            "set xlabel 'θ_h [°], spaced by its root'\n"
            "set tmargin at screen 0.865\nset bmargin at screen 0.155\n";
  script += "set label 1 " + GnuplotQuote(slices.Note()) +
            " at screen 0.5, screen 0.025 center noenhanced font ',17' textcolor '#444444'\n";
  for (int c = 0; c < kChannels; ++c) {
    const double left = 0.07 + 0.275 * c;
    script += "set lmargin at screen " + GnuplotNumber(left) + "\nset rmargin at screen " +
              GnuplotNumber(left + 0.25) + "\nset title '" + kChannelNames[c] + "' offset 0,-0.4\n";
    script +=
        c == 0 ? "set ylabel 'BRDF [1/sr] at φ_d ≈ 90°'\n" : "unset ylabel\nset format y ''\n";
    script +=
        c == 2 ? "set key at screen 0.995, screen 0.52 right center vertical spacing 1.5 enhanced\n"
               : "unset key\n";
    const char* comma = "plot ";
    const auto draw = [&](int column, const std::string& how) {
      script += comma + ("$channel" + std::to_string(c)) + " using 1:" + std::to_string(column) +
                " with " + how;
      comma = ", ";
    };
    for (int k = 0; k < kCurves; ++k) {
      const int first = 2 + k * kColumns;
      const std::string color = kColors[k], faint = Faint(kColors[k]);
      const int d = static_cast<int>(kThetaD[k] / 90 * grid.theta_d);
      const std::string dots = "points pointtype 7 pointsize 0.75 linecolor '";
      const std::string line = "lines linewidth 2.2 linecolor '";
      draw(first + kPale, dots + faint + "' notitle");
      draw(first + kPlain, dots + color + "' notitle");
      draw(first + kWays + kPale, line + faint + "' notitle");
      draw(first + kWays + kDotted, line + color + "' dashtype (2,3) notitle");
      draw(first + kWays + kPlain,
           line + color +
               "' title 'θ_d = " + GnuplotNumber(RadiansToDegrees(grid.ThetaD(d + 0.5))) + "°'");
    }
    script += "\nunset label\n";
  }
  DrawPng(path, kWidth, 1000, script);
}

// --- At nodes ------------------------------------------------------------------------------------

namespace {

constexpr int kStepsAround = 360;  // of a fitted line

// A row of panels: at each of a few thetas, values around the normal.
struct Row {
  const char* title;
  const char* x;      // of the axis
  const char* curve;  // what differs between curves
  // Angles of a curve at this theta and phi [rad].
  SphericalAngles (*at)(double theta, double phi, double middling);
};
constexpr Row kRows[] = {
    {"seen along the normal, as the sample turns", "φ_i [°]", "θ_i",
     [](double theta, double phi, double) {
       return SphericalAngles{theta, phi, 0, 0};
     }},
    {"lit from φ_i = 0", "φ_o [°]", "θ_o",
     [](double theta, double phi, double middling) {
       return SphericalAngles{middling, 0, theta, phi};
     }},
};

// At most kCurves of the grid's thetas, evenly, the largest that was measured among them.
std::vector<double> ThetasOf(const NodeTable& table) {
  const int last = std::min(static_cast<int>(table.max_theta / table.grid.ThetaStep() + 1e-6),
                            table.grid.thetas - 1);
  std::vector<double> thetas;
  const int curves = std::min(kCurves, std::max(last, 1));
  for (int k = 1; k <= curves; ++k) {
    thetas.push_back(static_cast<double>(std::lround(static_cast<double>(last) * k / curves)) *
                     table.grid.ThetaStep());
  }
  return thetas;
}

std::string Degrees(double radians) {
  return GnuplotNumber(std::round(RadiansToDegrees(radians) * 100) / 100) + "°";
}

}  // namespace

void DrawSlices(const NodeBrdf& measured, const SphericalBrdf& fitted, const std::string& path) {
  const NodeTable& table = measured.table();
  const std::vector<double> thetas = ThetasOf(table);
  const double middling = thetas[thetas.size() / 2];
  const auto positive = [](double x) { return x > 0 ? x : kNone; };
  std::string script;
  std::array<std::vector<double>, std::size(kRows)> values;
  for (size_t r = 0; r < std::size(kRows); ++r) {
    for (int c = 0; c < kChannels; ++c) {
      std::vector<std::vector<double>> points, lines;  // phi, then each theta
      for (int b = 0; b <= table.grid.phis; ++b) {
        std::vector<double>& row = points.emplace_back(1, 360.0 * b / table.grid.phis);
        for (const double theta : thetas) {
          const SphericalAngles at = kRows[r].at(theta, b * table.grid.PhiStep(), middling);
          row.push_back(measured.Measured(at) ? positive(measured(at)[c]) : kNone);
          values[r].push_back(row.back());
        }
      }
      for (int k = 0; k <= kStepsAround; ++k) {
        std::vector<double>& row = lines.emplace_back(1, 360.0 * k / kStepsAround);
        for (const double theta : thetas) {
          row.push_back(
              positive(fitted(kRows[r].at(theta, 2 * kPi * k / kStepsAround, middling))[c]));
          values[r].push_back(row.back());
        }
      }
      const std::string name = std::to_string(r) + "_" + std::to_string(c);
      script += GnuplotData("points" + name, points) + GnuplotData("lines" + name, lines);
    }
  }
  script += "set multiplot title " +
            GnuplotTitle("Measured (points) and fitted (lines): " + FileNameOf(table.source),
                         kWidth, 22) +
            "\nset logscale y\nset xrange [0:360]\nset xtics 0,60,300 add ('' 360)\n";
  for (size_t r = 0; r < std::size(kRows); ++r) {
    const double top = 0.865 - 0.465 * static_cast<double>(r), bottom = top - 0.325;
    script += "set tmargin at screen " + GnuplotNumber(top) + "\nset bmargin at screen " +
              GnuplotNumber(bottom) + "\nset yrange " + GnuplotLogRange(values[r], 6) +
              "\nset label 1 '" + kRows[r].title + (r == 1 ? ", θ_i = " + Degrees(middling) : "") +
              "' at screen 0.47, screen " + GnuplotNumber(top + 0.05) + " center font ',19'\n";
    for (int c = 0; c < kChannels; ++c) {
      const double left = 0.085 + 0.27 * c;
      script += "set lmargin at screen " + GnuplotNumber(left) + "\nset rmargin at screen " +
                GnuplotNumber(left + 0.245) + "\nset title '" + kChannelNames[c] +
                "' offset 0,-0.4\nset xlabel '" + kRows[r].x + "'\n";
      script += c == 0 ? "set ylabel 'BRDF [1/sr]'\n" + LogTics(LogRange(values[r], 6), 'y')
                       : std::string("unset ylabel\nset format y ''\n");
      script += c == 2 ? "set key at screen 0.995, screen " + GnuplotNumber((top + bottom) / 2) +
                             " right center vertical spacing 1.5 enhanced\n"
                       : "unset key\n";
      const std::string name = std::to_string(r) + "_" + std::to_string(c);
      for (size_t k = 0; k < thetas.size(); ++k) {
        const std::string column = std::to_string(2 + k);
        script += (k == 0 ? "plot $points" : ", $points") + name + " using 1:" + column +
                  " with points pointtype 7 pointsize 0.75 linecolor '" + kColors[k] +
                  "' notitle, $lines" + name + " using 1:" + column +
                  " with lines linewidth 2.2 linecolor '" + kColors[k] + "' title '" +
                  kRows[r].curve + " = " + Degrees(thetas[k]) + "'";
      }
      script += "\nunset label\n";
    }
  }
  DrawPng(path, kWidth, 1400, script);
}

// --- Scattered samples on no grid ----------------------------------------------------------------

namespace {

constexpr int kStepsInPlane = 356;                   // of a fitted line
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
  const size_t curves = std::min<size_t>(kCurves, enough.size());
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
    for (int step = 0; step <= kStepsInPlane; ++step) {
      const double theta_o = last * (2.0 * step / kStepsInPlane - 1);
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
            GnuplotTitle("Measured (points) and fitted (lines): " + FileNameOf(scattered.source),
                         kWidth, 22) +
            "\nset logscale y\nset xrange [-90:90]\nset xtics -60,30,60 add ('' -90, '' 90)\nset "
            "yrange [" +
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
