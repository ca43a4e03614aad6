#include "trilobe/io/plot_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "trilobe/appearance/color.h"
#include "trilobe/io/gnuplot.h"
#include "trilobe/io/image_file.h"

namespace trilobe {
namespace {

constexpr int kGutter = 24;  // between panels
constexpr int kTop = 130, kBottom = 110;
constexpr int kRight = 180;  // for the colour bar
constexpr int kMargin = 3;   // of rendered pixels, around the sphere

// The canvas and its three panels, in pixels.
struct Layout {
  int rows = 1;    // squares, one above another, in a panel
  int size = 600;  // of a square
  int left = kGutter;

  int width() const { return left + 3 * (size + kGutter) + kRight; }
  int height() const { return kTop + rows * size + kBottom; }
  int PanelLeft(int index) const { return left + index * (size + kGutter); }
};

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

struct Raster {
  int width = 0, height = 0;
  std::string bytes = {};  // [height * width * 3], sRGB
};

// `linear(pixel)` on the object and `background` off it. A sphere gets a margin and a soft edge: a
// pixel at the rim shows as much of the sphere as covers it.
template <typename Linear>
Raster Rasterize(const RenderedImage& image, const Rgb& background, const Linear& linear) {
  const int rows = static_cast<int>(image.radiance.size()) / image.size;
  const bool fills = image.coverage.front() >= 0;
  const int margin = fills ? 0 : kMargin;
  Raster raster{image.size + 2 * margin, rows + 2 * margin};
  const double radius = image.size / 2.0;
  for (int y = 0; y < raster.height; ++y) {
    for (int x = 0; x < raster.width; ++x) {
      const double dx = x + 0.5 - raster.width / 2.0, dy = y + 0.5 - raster.height / 2.0;
      const double distance = std::hypot(dx, dy);
      const double share = fills ? 1 : std::clamp(radius - distance + 0.5, 0.0, 1.0);
      Rgb color = background;
      if (share > 0) {
        // The nearest pixel whose middle is on the sphere.
        const double inward = fills ? 1 : std::min(1.0, (radius - 1) / std::max(distance, 1e-9));
        const int column = static_cast<int>(dx * inward + radius);
        const int row = static_cast<int>(dy * inward + rows / 2.0);
        const Rgb on_object = linear(row * image.size + column);
        for (int c = 0; c < kChannels; ++c) color[c] += share * (on_object[c] - background[c]);
      }
      for (const double c : color) raster.bytes += Byte(EncodeSrgb(c));
    }
  }
  return raster;
}

// A black measurement has none: whatever the fit shows, as it is.
double ExposureOf(const SphereError& error) { return error.exposure > 0 ? error.exposure : 1; }

Rgb Exposed(const Rgb& radiance, double exposure) {
  Rgb color = radiance;
  for (double& c : color) c = std::clamp(c * exposure, 0.0, 1.0);
  return color;
}

Raster ToneMapped(const RenderedImage& image, double exposure) {
  return Rasterize(image, kDarkBackground,
                   [&](int pixel) { return Exposed(image.radiance[pixel], exposure); });
}

// CIELAB differences where most of the light on a pixel is of measured directions, below 0
// elsewhere.
std::vector<double> DeltaE(const ImagePair& pair, double exposure) {
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
std::string Place(const Raster& raster, int x, int y, int w, int h, const Layout& layout) {
  const auto fraction = [](int a, int b) { return GnuplotNumber(static_cast<double>(a) / b); };
  const int width = layout.width(), height = layout.height();
  return "set lmargin at screen " + fraction(x, width) + "\nset rmargin at screen " +
         fraction(x + w, width) + "\nset tmargin at screen " + fraction(height - y, height) +
         "\nset bmargin at screen " + fraction(height - y - h, height) +
         "\nset xrange [-0.5:" + GnuplotNumber(raster.width - 0.5) + "]\nset yrange [" +
         GnuplotNumber(raster.height - 0.5) + ":-0.5]\nplot '-' binary array=(" +
         std::to_string(raster.width) + "," + std::to_string(raster.height) +
         ") format='%uchar' using 1:2:3 with rgbimage notitle\n" + raster.bytes;
}

std::string ColorBar(double range, const Layout& layout) {
  constexpr int kSteps = 256, kColumns = 2;  // gnuplot draws no image of one column
  Raster raster{kColumns, kSteps};
  for (int row = 0; row < kSteps; ++row) {
    const Rgb color = DifferenceColor(1 - (row + 0.5) / kSteps);
    for (int column = 0; column < kColumns; ++column) {
      for (const double c : color) raster.bytes += Byte(c);
    }
  }
  std::string tics;
  for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    tics += std::string(tics.empty() ? "" : ", ") + "'" + GnuplotNumber(range * t) + "' " +
            GnuplotNumber((1 - t) * kSteps - 0.5);
  }
  const int height = layout.rows * layout.size;
  return "unset title\nset border 15 linecolor '#555555'\nset y2tics (" + tics +
         ") out\nset y2range [" + GnuplotNumber(kSteps - 0.5) + ":-0.5]\n" +
         Place(raster, layout.PanelLeft(3), kTop + height / 8, 26, height * 3 / 4, layout);
}

// White lines between the squares of a panel.
std::string Separators(const Layout& layout) {
  std::string script;
  for (int k = 1; k < layout.rows; ++k) {
    const std::string y = GnuplotNumber(static_cast<double>(k) / layout.rows);
    script += "set arrow from graph 0, graph " + y + " to graph 1, graph " + y +
              " nohead front linecolor '#FFFFFF' linewidth 8\n";
  }
  return script;
}

// The texts left of the squares, upwards.
std::string RowLabels(const std::vector<std::string>& rows, const Layout& layout) {
  std::string script;
  for (size_t k = 0; k < rows.size(); ++k) {
    const double y = kTop + (static_cast<double>(k) + 0.5) * layout.size;
    script += "set label " + std::to_string(4 + k) + " " + GnuplotQuote(rows[k]) + " at screen " +
              GnuplotNumber(0.45 * layout.left / layout.width()) + ", screen " +
              GnuplotNumber(1 - y / layout.height()) +
              " center rotate by 90 font ',20' textcolor '#111111'\n";
  }
  return script;
}

}  // namespace

void DrawImagePair(const PairPicture& picture, const AppearanceOptions& options,
                   const std::string& path) {
  const ImagePair& whole = picture.whole;
  const SphereError error = CompareSpheres(picture.counted.measured, picture.counted.fitted);
  const double exposure = ExposureOf(error);
  const std::vector<double> delta_e = DeltaE(picture.counted, exposure);
  const double range = ColorRange(delta_e);
  bool all_measured = true;
  const Raster map = Rasterize(whole.measured, kLightBackground, [&](int pixel) {
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
  const Layout layout = picture.rows.empty() ? Layout{}
                                             : Layout{.rows = static_cast<int>(picture.rows.size()),
                                                      .size = 480,
                                                      .left = kGutter + 40};
  const auto screen_y = [&](int pixels_from_bottom) {
    return ", screen " + GnuplotNumber(static_cast<double>(pixels_from_bottom) / layout.height());
  };
  std::string script = "set multiplot\nunset border\nunset tics\nunset grid\nunset key\n";
  script += "set label 1 " + GnuplotQuote(picture.source) + " at screen 0.5" +
            screen_y(layout.height() - 38) + " center noenhanced font ',26' textcolor '#111111'\n" +
            "set label 2 " +
            GnuplotQuote("lit by " + std::to_string(options.lights) + " lights drawn from " +
                         EnvironmentOf(options).name) +
            " at screen 0.5" + screen_y(71) +
            " center noenhanced font ',17' textcolor '#444444'\n" + "set label 3 '" +
            caption.data() + "' at screen 0.5" + screen_y(34) +
            " center font ',17' textcolor '#444444'\n" + RowLabels(picture.rows, layout) +
            Separators(layout);
  const auto panel = [&](int index, const char* title, const Raster& raster) {
    script += std::string("set title '") + title + "' font ',22' offset 0,-0.3\n" +
              Place(raster, layout.PanelLeft(index), kTop, layout.size, layout.rows * layout.size,
                    layout) +
              "unset label\n";
  };
  panel(0, "measured", ToneMapped(whole.measured, exposure));
  panel(1, "fitted", ToneMapped(whole.fitted, exposure));
  panel(2, "difference (CIELAB ΔE)", map);
  script += "unset arrow\n" + ColorBar(range, layout);
  DrawPng(path, layout.width(), layout.height(), script);
}

void WriteImagePair(const PairPicture& picture, const std::string& path) {
  const double exposure =
      ExposureOf(CompareSpheres(picture.counted.measured, picture.counted.fitted));
  const Raster left = ToneMapped(picture.whole.measured, exposure);
  const Raster right = ToneMapped(picture.whole.fitted, exposure);
  const size_t row = static_cast<size_t>(left.width) * kChannels;
  std::string pixels;
  for (size_t at = 0; at < left.bytes.size(); at += row) {
    pixels += left.bytes.substr(at, row) + right.bytes.substr(at, row);
  }
  WritePng(path, 2 * left.width, left.height, pixels);
}

void WriteImage(const RenderedImage& image, const std::string& path) {
  const Raster raster = ToneMapped(image, ExposureOf(CompareSpheres(image, image)));
  WritePng(path, raster.width, raster.height, raster.bytes);
}

}  // namespace trilobe
