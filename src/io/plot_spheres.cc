#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "trilobe/appearance/appearance.h"
#include "trilobe/appearance/color.h"
#include "trilobe/io/gnuplot.h"
#include "trilobe/io/image_file.h"
#include "trilobe/io/plots.h"

namespace trilobe {
namespace {

constexpr int kSize = 600;   // of a sphere, in pixels
constexpr int kGutter = 24;  // between panels
constexpr int kTop = 130, kBottom = 110;
constexpr int kRight = 180;  // for the colour bar
constexpr int kWidth = 3 * kSize + 4 * kGutter + kRight, kHeight = kTop + kSize + kBottom;
constexpr int kMargin = 3;  // of rendered pixels, around the sphere

constexpr Rgb kDarkBackground = {0.012, 0.013, 0.016};  // linear
constexpr Rgb kLightBackground = {1, 1, 1};
constexpr Rgb kNotMeasured = {0.6, 0.6, 0.6};

// From white by yellow and red to dark, as differences grow, legible to the colour-blind
// (ColorBrewer YlOrRd), in sRGB codes / 255.
Rgb DifferenceColor(double x) {
  static constexpr Rgb kStops[] = {
      {255, 255, 255}, {254, 217, 118}, {253, 141, 60}, {189, 0, 38}, {60, 0, 30}};
  const double position = std::clamp(x, 0.0, 1.0) * 4;
  const int i = std::min(static_cast<int>(position), 3);
  const double t = position - i;
  Rgb color;
  for (int c = 0; c < kChannels; ++c) {
    color[c] = ((1 - t) * kStops[i][c] + t * kStops[i + 1][c]) / 255;
  }
  return color;
}

char Byte(double code) {
  return static_cast<char>(
      static_cast<unsigned char>(std::lround(std::clamp(code, 0.0, 1.0) * 255)));
}

int Side(const SphereImage& image) { return image.size + 2 * kMargin; }

// `linear(pixel)` on the sphere and `background` off it, in sRGB, with a soft edge: a pixel at the
// rim shows as much of the sphere as covers it. [Side()^2 * 3]
template <typename Linear>
std::string Rasterize(const SphereImage& image, const Rgb& background, const Linear& linear) {
  const int side = Side(image);
  const double radius = image.size / 2.0;
  std::string bytes;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const double dx = x + 0.5 - side / 2.0, dy = y + 0.5 - side / 2.0;
      const double distance = std::hypot(dx, dy);
      const double share = std::clamp(radius - distance + 0.5, 0.0, 1.0);
      Rgb color = background;
      if (share > 0) {
        // The nearest pixel whose middle is on the sphere.
        const double inward = std::min(1.0, (radius - 1) / std::max(distance, 1e-9));
        const int column = static_cast<int>(dx * inward + radius);
        const int row = static_cast<int>(dy * inward + radius);
        const Rgb on_sphere = linear(row * image.size + column);
        for (int c = 0; c < kChannels; ++c) {
          color[c] += share * (on_sphere[c] - background[c]);
        }
      }
      for (const double c : color) bytes += Byte(EncodeSrgb(c));
    }
  }
  return bytes;
}

// A black measurement has none: whatever the fit shows, as it is.
double ExposureOf(const SphereError& error) { return error.exposure > 0 ? error.exposure : 1; }

Rgb Exposed(const Rgb& radiance, double exposure) {
  Rgb color = radiance;
  for (double& c : color) c = std::clamp(c * exposure, 0.0, 1.0);
  return color;
}

std::string ToneMapped(const SphereImage& image, double exposure) {
  return Rasterize(image, kDarkBackground,
                   [&](int pixel) { return Exposed(image.radiance[pixel], exposure); });
}

// CIELAB differences where most of the light on a pixel is of measured directions, below 0
// elsewhere.
std::vector<double> DeltaE(const SpherePair& pair, double exposure) {
  std::vector<double> delta_e(pair.measured.radiance.size(), -1.0);
  for (size_t k = 0; k < delta_e.size(); ++k) {
    if (pair.measured.coverage[k] < 0.5) continue;
    delta_e[k] = LabDifference(ToLab(Exposed(pair.measured.radiance[k], exposure)),
                               ToLab(Exposed(pair.fitted.radiance[k], exposure)));
  }
  return delta_e;
}

// The least round number that holds 98 % of the sphere's differences.
double ColorRange(const std::vector<double>& delta_e) {
  std::vector<double> sorted;
  for (const double x : delta_e) {
    if (x >= 0) sorted.push_back(x);
  }
  if (sorted.empty()) return 1;
  std::ranges::sort(sorted);
  const double needed = sorted[static_cast<size_t>(0.98 * static_cast<double>(sorted.size() - 1))];
  for (const double range : {1.0, 2.0, 5.0, 10.0, 20.0, 50.0}) {
    if (needed <= range) return range;
  }
  return 100;
}

// Commands for an image of size w x h at pixel (x, y) of the canvas, from its top left.
std::string Place(const std::string& pixels, int x, int y, int w, int h, int columns, int rows) {
  const auto fraction = [](int a, int b) { return GnuplotNumber(static_cast<double>(a) / b); };
  return "set lmargin at screen " + fraction(x, kWidth) + "\nset rmargin at screen " +
         fraction(x + w, kWidth) + "\nset tmargin at screen " + fraction(kHeight - y, kHeight) +
         "\nset bmargin at screen " + fraction(kHeight - y - h, kHeight) +
         "\nset xrange [-0.5:" + GnuplotNumber(columns - 0.5) + "]\nset yrange [" +
         GnuplotNumber(rows - 0.5) + ":-0.5]\nplot '-' binary array=(" + std::to_string(columns) +
         "," + std::to_string(rows) + ") format='%uchar' using 1:2:3 with rgbimage notitle\n" +
         pixels;
}

std::string ColorBar(double range) {
  constexpr int kSteps = 256, kColumns = 2;  // gnuplot draws no image of one column
  std::string pixels;
  for (int row = 0; row < kSteps; ++row) {
    const Rgb color = DifferenceColor(1 - (row + 0.5) / kSteps);
    for (int column = 0; column < kColumns; ++column) {
      for (const double c : color) pixels += Byte(c);
    }
  }
  std::string tics;
  for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    tics += std::string(tics.empty() ? "" : ", ") + "'" + GnuplotNumber(range * t) + "' " +
            GnuplotNumber((1 - t) * kSteps - 0.5);
  }
  return "unset title\nset border 15 linecolor '#555555'\nset y2tics (" + tics +
         ") out\nset y2range [" + GnuplotNumber(kSteps - 0.5) + ":-0.5]\n" +
         Place(pixels, 3 * kSize + 4 * kGutter, kTop + kSize / 8, 26, kSize * 3 / 4, kColumns,
               kSteps);
}

}  // namespace

void DrawSpheres(const BrdfTable& measured, const AngularBrdf& fitted, const std::string& path,
                 AppearanceOptions options) {
  options.size = 320;
  const SpherePair counted = RenderMeasuredPair(measured, fitted, options);
  const SpherePair pair =
      measured.unmeasured.empty() ? counted : RenderSpherePair(measured, fitted, options);
  const SphereError error = CompareSpheres(counted.measured, counted.fitted);
  const double exposure = ExposureOf(error);
  const std::vector<double> delta_e = DeltaE(counted, exposure);
  const double range = ColorRange(delta_e);
  bool all_measured = true;
  const std::string map = Rasterize(pair.measured, kLightBackground, [&](int pixel) {
    all_measured = all_measured && delta_e[pixel] >= 0;
    Rgb color = delta_e[pixel] < 0 ? kNotMeasured : DifferenceColor(delta_e[pixel] / range);
    for (double& c : color) c = LinearizeSrgb(c);
    return color;
  });

  std::array<char, 300> caption;
  std::string psnr = "infinite";
  if (std::isfinite(error.psnr_db)) {
    std::snprintf(caption.data(), caption.size(), "%.1f", error.psnr_db);
    psnr = caption.data();
  }
  std::snprintf(caption.data(), caption.size(),
                "exposed to a mean luminance of %g, sRGB curve, clipped at 1; PSNR %s dB, mean "
                "ΔE %.2f%s",
                kMeanLuminance, psnr.c_str(), error.mean_delta_e,
                all_measured ? "" : ", of measured directions; grey: none");
  const std::string environment =
      options.environment != nullptr ? options.environment->name : StudioEnvironment().name;
  std::string script = "set multiplot\nunset border\nunset tics\nunset grid\nunset key\n";
  script += "set label 1 " + GnuplotQuote(measured.source) +
            " at screen 0.5, screen 0.955 center noenhanced font ',26' textcolor '#111111'\n" +
            "set label 2 " +
            GnuplotQuote("lit by " + std::to_string(options.lights) + " lights drawn from " +
                         environment) +
            " at screen 0.5, screen 0.085 center noenhanced font ',17' textcolor '#444444'\n" +
            "set label 3 '" + caption.data() +
            "' at screen 0.5, screen 0.04 center font ',17' textcolor '#444444'\n";
  const int side = Side(pair.measured);
  const auto panel = [&](int index, const char* title, const std::string& pixels) {
    script += std::string("set title '") + title + "' font ',22' offset 0,-0.3\n" +
              Place(pixels, kGutter + index * (kSize + kGutter), kTop, kSize, kSize, side, side) +
              "unset label\n";
  };
  panel(0, "measured", ToneMapped(pair.measured, exposure));
  panel(1, "fitted", ToneMapped(pair.fitted, exposure));
  panel(2, "difference (CIELAB ΔE)", map);
  script += ColorBar(range);
  DrawPng(path, kWidth, kHeight, script);
}

void WriteSpherePair(const BrdfTable& measured, const AngularBrdf& fitted, const std::string& path,
                     const AppearanceOptions& options) {
  const SpherePair pair = RenderSpherePair(measured, fitted, options);
  const double exposure = ExposureOf(CompareOnSphere(measured, fitted, options));
  const std::string left = ToneMapped(pair.measured, exposure);
  const std::string right = ToneMapped(pair.fitted, exposure);
  const int side = Side(pair.measured);
  const size_t row = static_cast<size_t>(side) * kChannels;
  std::string pixels;
  for (size_t at = 0; at < left.size(); at += row) {
    pixels += left.substr(at, row) + right.substr(at, row);
  }
  WritePng(path, 2 * side, side, pixels);
}

}  // namespace trilobe
