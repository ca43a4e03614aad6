#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "trilobe/io/gnuplot.h"
#include "trilobe/io/plots.h"
#include "trilobe/io/sphere_image.h"

namespace trilobe {
namespace {

constexpr int kSize = 600;   // of a sphere, in pixels
constexpr int kGutter = 24;  // between panels
constexpr int kTop = 130, kBottom = 80;
constexpr int kRight = 180;  // for the colour bar
constexpr int kWidth = 3 * kSize + 4 * kGutter + kRight, kHeight = kTop + kSize + kBottom;

constexpr Rgb kDarkBackground = {0.012, 0.013, 0.016};  // linear
constexpr Rgb kLightBackground = {1, 1, 1};

// Diverging from blue by white to red, colour-blind-safe (ColorBrewer RdBu), in sRGB codes / 255.
Rgb DivergingColor(double x) {
  static constexpr Rgb kStops[] = {
      {33, 102, 172}, {103, 169, 207}, {247, 247, 247}, {239, 138, 98}, {178, 24, 43}};
  const double position = (std::clamp(x, -1.0, 1.0) + 1) * 2;
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

// The mean over each pixel of `linear(sample)` on the sphere and of `background` off it, in sRGB.
template <typename Linear>
std::string Rasterize(const SphereImage& image, const Rgb& background, const Linear& linear) {
  constexpr int kSamples = SphereImage::kSamples;
  const int side = image.size * kSamples;
  std::string bytes;
  for (int y = 0; y < image.size; ++y) {
    for (int x = 0; x < image.size; ++x) {
      Rgb sum{};
      for (int k = 0; k < kSamples * kSamples; ++k) {
        const int sample = (y * kSamples + k / kSamples) * side + x * kSamples + k % kSamples;
        const Rgb color = image.on_sphere[sample] ? linear(sample) : background;
        for (int c = 0; c < kChannels; ++c) sum[c] += color[c] / (kSamples * kSamples);
      }
      for (const double c : sum) bytes += Byte(EncodeSrgb(c));
    }
  }
  return bytes;
}

std::string ToneMapped(const SphereImage& image, double exposure) {
  return Rasterize(image, kDarkBackground, [&](int sample) {
    Rgb color = image.radiance[sample];
    for (double& c : color) c = std::min(c * exposure, 1.0);
    return color;
  });
}

double LinearizeSrgb(double code) {
  return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
}

double Percentile(std::vector<double> values, double fraction) {
  if (values.empty()) return 0;
  const auto nth = values.begin() +
                   static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, nth);
  return *nth;
}

// The power of two that takes the 85th percentile of the sphere's luminance nearest to 0.35.
double Exposure(const SphereImage& image) {
  std::vector<double> luminance;
  for (const Rgb& radiance : image.radiance) {
    const double y = Luminance(radiance);
    if (y > 0) luminance.push_back(y);
  }
  const double level = Percentile(std::move(luminance), 0.85);
  return level > 0 ? std::exp2(std::round(std::log2(0.35 / level))) : 1;
}

// Relative difference of luminance, fitted to measured. [samples], 0 off the sphere.
// The floor keeps pixels that both pictures show as black from ruling the map.
std::vector<double> RelativeDifference(const SphereImage& measured, const SphereImage& fitted,
                                       double floor) {
  std::vector<double> difference(measured.radiance.size());
  for (size_t i = 0; i < difference.size(); ++i) {
    const double a = Luminance(measured.radiance[i]), b = Luminance(fitted.radiance[i]);
    if (measured.on_sphere[i]) difference[i] = (b - a) / (a + floor);
  }
  return difference;
}

// The least round number that holds 95 % of the sphere's differences.
double ColorRange(const std::vector<double>& difference) {
  std::vector<double> magnitude;
  for (const double x : difference) {
    if (x != 0) magnitude.push_back(std::abs(x));
  }
  const double needed = Percentile(std::move(magnitude), 0.95);
  for (const double range : {0.01, 0.02, 0.05, 0.1, 0.2, 0.5}) {
    if (needed <= range) return range;
  }
  return 1;
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
    const Rgb color = DivergingColor(1 - 2 * (row + 0.5) / kSteps);
    for (int column = 0; column < kColumns; ++column) {
      for (const double c : color) pixels += Byte(c);
    }
  }
  std::string tics;
  for (const double t : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
    char label[32];
    std::snprintf(label, sizeof label, "%+g %%%%", 100 * range * t);
    tics += std::string(tics.empty() ? "" : ", ") + "'" + (t == 0 ? "0" : label) + "' " +
            GnuplotNumber((1 - t) / 2 * kSteps - 0.5);
  }
  return "unset title\nset border 15 linecolor '#555555'\nset y2tics (" + tics +
         ") out\nset y2range [" + GnuplotNumber(kSteps - 0.5) + ":-0.5]\n" +
         Place(pixels, 3 * kSize + 4 * kGutter, kTop + kSize / 8, 26, kSize * 3 / 4, kColumns,
               kSteps);
}

}  // namespace

void DrawSpheres(const BrdfTable& measured, const BrdfTable& fitted, const std::string& path,
                 int num_threads) {
  const SphereImage left = RenderSphere(measured, kSize, num_threads);
  const SphereImage right = RenderSphere(fitted, kSize, num_threads);
  const double exposure = Exposure(left);
  const std::vector<double> difference = RelativeDifference(left, right, 0.002 / exposure);
  const double range = ColorRange(difference);
  const std::string map = Rasterize(left, kLightBackground, [&](int sample) {
    Rgb color = DivergingColor(difference[sample] / range);
    for (double& c : color) c = LinearizeSrgb(c);
    return color;
  });

  char caption[200];
  std::snprintf(caption, sizeof caption,
                "lights from upper left, right and behind; exposure × %g, clipped, sRGB curve; "
                "difference of luminance",
                exposure);
  std::string script = "set multiplot\nunset border\nunset tics\nunset grid\nunset key\n";
  script += "set label 1 " + GnuplotQuote(measured.source) +
            " at screen 0.5, screen 0.955 center noenhanced font ',26' textcolor '#111111'\n" +
            "set label 2 '" + caption +
            "' at screen 0.5, screen 0.045 center font ',17' textcolor '#444444'\n";
  const auto panel = [&](int index, const char* title, const std::string& pixels) {
    script += std::string("set title '") + title + "' font ',22' offset 0,-0.3\n" +
              Place(pixels, kGutter + index * (kSize + kGutter), kTop, kSize, kSize, kSize, kSize) +
              "unset label\n";
  };
  panel(0, "measured", ToneMapped(left, exposure));
  panel(1, "fitted", ToneMapped(right, exposure));
  panel(2, "(fitted − measured) / measured", map);
  script += ColorBar(range);
  DrawPng(path, kWidth, kHeight, script);
}

}  // namespace trilobe
