#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/file_names.h"
#include "io/pictures/gnuplot.h"
#include "io/pictures/image_file.h"
#include "io/pictures/plots.h"
#include "io/pictures/words.h"
#include "model/appearance/color.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/appearance/appearance.h"

namespace trilobe {
namespace {

// Pictures of a measured and a fitted material, of a sphere or of what fills the picture.
struct PairPicture {
  std::string source;
  // Texts left of the squares that the pictures consist of, one above another; or none, of one.
  std::vector<std::string> rows;
  SphereError error;                  // the figures below
  std::string subject;                // what they are of
  ImagePairs images;                  // of these the map of differences shows what was measured
  const char* measured = "measured";  // what the first panel is
};

constexpr int kGutter = 24;  // between panels
constexpr int kTop = 130, kBottom = 110;
constexpr int kRight = 180;  // for the colour bar
constexpr int kMargin = 3;   // around the sphere

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

// Colours from white by yellow and red to dark, as differences grow, legible to the colour-blind
// (ColorBrewer YlOrRd), in sRGB codes / 255: the same colours for the same differences in all
// pictures. Differences that cannot be seen are nearly white, those that are seen side by side are
// orange.
struct DifferenceStop {
  double delta_e;
  Rgb color;
};
constexpr DifferenceStop kDifferenceStops[] = {{0, {255, 255, 255}},
                                               {1, {255, 237, 160}},
                                               {2, {254, 178, 76}},
                                               {5, {227, 26, 28}},
                                               {10, {60, 0, 30}}};
constexpr int kLastStop = std::size(kDifferenceStops) - 1;

// `position` is from 0 to 1, the stops being at equal steps.
Rgb DifferenceColorAt(double position) {
  const double x = std::clamp(position, 0.0, 1.0) * kLastStop;
  const int i = std::min(static_cast<int>(x), kLastStop - 1);
  Rgb color;
  for (int c = 0; c < kChannels; ++c) {
    color[c] =
        std::lerp(kDifferenceStops[i].color[c], kDifferenceStops[i + 1].color[c], x - i) / 255;
  }
  return color;
}

Rgb DifferenceColor(double delta_e) {
  int i = 0;
  while (i < kLastStop - 1 && delta_e > kDifferenceStops[i + 1].delta_e) ++i;
  const double from = kDifferenceStops[i].delta_e, end = kDifferenceStops[i + 1].delta_e;
  return DifferenceColorAt((i + (delta_e - from) / (end - from)) / kLastStop);
}

char Byte(double code) {
  return static_cast<char>(
      static_cast<unsigned char>(std::lround(std::clamp(code, 0.0, 1.0) * 255)));
}

struct Raster {
  int width = 0, height = 0;
  std::string bytes = {};  // [height * width * 3], sRGB
};

// `linear(pixel)` on the object, linear between the middles of its pixels, and `background` off it,
// so that the object is `size` pixels wide. A sphere gets a margin and a soft edge.
template <typename Linear>
Raster Rasterize(const RenderedImage& image, int size, const Rgb& background, const Linear& linear,
                 int sphere_margin = kMargin) {
  const int pixels = static_cast<int>(image.radiance.size()), rows = pixels / image.size;
  std::vector<Rgb> colors(pixels);
  for (int k = 0; k < pixels; ++k) {
    if (image.coverage[k] >= 0) colors[k] = linear(k);
  }
  const auto at = [&](double x, double y) {  // in pixels of the image
    const int column = static_cast<int>(std::floor(x - 0.5));
    const int row = static_cast<int>(std::floor(y - 0.5));
    Rgb sum{};
    double weights = 0;
    for (int k = 0; k < 4; ++k) {
      const int i = column + k % 2, j = row + k / 2;
      if (i < 0 || i >= image.size || j < 0 || j >= rows) continue;
      const int pixel = j * image.size + i;
      if (image.coverage[pixel] < 0) continue;
      const double weight = (1 - std::abs(x - 0.5 - i)) * (1 - std::abs(y - 0.5 - j));
      weights += weight;
      for (int c = 0; c < kChannels; ++c) sum[c] += weight * colors[pixel][c];
    }
    for (double& c : sum) c /= std::max(weights, 1e-12);
    return sum;
  };
  const bool fills = image.coverage.front() >= 0;
  const int margin = fills ? 0 : sphere_margin;
  const double scale = static_cast<double>(image.size) / size;
  Raster raster{size + 2 * margin, size * rows / image.size + 2 * margin};
  const double radius = size / 2.0;
  for (int y = 0; y < raster.height; ++y) {
    for (int x = 0; x < raster.width; ++x) {
      const double dx = x + 0.5 - raster.width / 2.0, dy = y + 0.5 - raster.height / 2.0;
      const double distance = std::hypot(dx, dy);
      const double share = fills ? 1 : std::clamp(radius - distance + 0.5, 0.0, 1.0);
      Rgb color = background;
      if (share > 0) {
        // At the rim what is seen next to it, where pixels have their middles on the sphere.
        const double inward =
            fills ? 1 : std::min(1.0, (radius - 1 / scale) / std::max(distance, 1e-9));
        const Rgb on_object = at((dx * inward + radius) * scale, dy * inward * scale + rows / 2.0);
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

Raster ToneMapped(const RenderedImage& image, int size, double exposure, int margin = kMargin) {
  return Rasterize(
      image, size, kDarkBackground,
      [&](int pixel) { return Exposed(image.radiance[pixel], exposure); }, margin);
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

std::string ColorBar(const Layout& layout) {
  constexpr int kSteps = 256, kColumns = 2;  // gnuplot draws no image of one column
  Raster raster{kColumns, kSteps};
  for (int row = 0; row < kSteps; ++row) {
    const Rgb color = DifferenceColorAt(1 - (row + 0.5) / kSteps);
    for (int column = 0; column < kColumns; ++column) {
      for (const double c : color) raster.bytes += Byte(c);
    }
  }
  std::string tics;
  for (int i = 0; i <= kLastStop; ++i) {
    tics += std::string(i == 0 ? "" : ", ") + "'" + (i == kLastStop ? "≥ " : "") +
            GnuplotNumber(kDifferenceStops[i].delta_e) + "' " +
            GnuplotNumber((1 - static_cast<double>(i) / kLastStop) * kSteps - 0.5);
  }
  const int height = layout.rows * layout.size;
  return "set title 'CIELAB ΔE' font ',17' offset 4,0.2\nset border 15 linecolor '#555555'\nset "
         "y2tics (" +
         tics + ") out\nset y2range [" + GnuplotNumber(kSteps - 0.5) + ":-0.5]\n" +
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

// Draws them side by side, exposed alike, and how far apart they are to the eye, in colours that
// mean the same in all pictures; the options say what they were lit by.
void DrawImagePair(const PairPicture& picture, const AppearanceOptions& options,
                   const std::string& path) {
  const ImagePair &counted = picture.images.counted, &whole = picture.images.whole;
  const double exposure = ExposureOf(CompareSpheres(counted.measured, counted.fitted));
  const std::vector<double> delta_e = DeltaE(counted, exposure);
  const Layout layout = picture.rows.empty() ? Layout{}
                                             : Layout{.rows = static_cast<int>(picture.rows.size()),
                                                      .size = 480,
                                                      .left = kGutter + 40};
  const int object = picture.rows.empty() ? layout.size - 2 * kMargin : layout.size;
  bool all_measured = true;
  std::array<Raster, 3> panels;
  ParallelFor(3, options.num_threads, [&](int k) {
    if (k < 2) {
      panels[k] = ToneMapped(k == 0 ? whole.measured : whole.fitted, object, exposure);
      return;
    }
    panels[k] = Rasterize(whole.measured, object, kLightBackground, [&](int pixel) {
      all_measured = all_measured && delta_e[pixel] >= 0;
      Rgb color = delta_e[pixel] < 0 ? kNotMeasured : DifferenceColor(delta_e[pixel]);
      for (double& c : color) c = LinearizeSrgb(c);
      return color;
    });
  });

  std::array<char, 300> figures;
  if (std::isfinite(picture.error.psnr_db)) {
    std::snprintf(figures.data(), figures.size(), "PSNR %.1f dB", picture.error.psnr_db);
  } else {
    std::snprintf(figures.data(), figures.size(), "equal");
  }
  const std::string psnr = figures.data();
  std::snprintf(figures.data(), figures.size(), "%s, mean ΔE %.2g, of %s", psnr.c_str(),
                picture.error.mean_delta_e, picture.subject.c_str());
  std::array<char, 100> exposed;
  std::snprintf(exposed.data(), exposed.size(), ", mean luminance %g, sRGB", kMeanLuminance);
  // Texts in lines from the bottom.
  const auto line = [&](int number, const std::string& text, int y) {
    return "set label " + std::to_string(number) + " " + GnuplotQuote(text) +
           " at screen 0.5, screen " + GnuplotNumber(static_cast<double>(y) / layout.height()) +
           " center noenhanced font ',17' textcolor '#444444'\n";
  };
  std::string script = "set multiplot\nunset border\nunset tics\nunset grid\nunset key\n";
  script += "set label 1 " + GnuplotTitle(FileNameOf(picture.source), layout.width(), 26) +
            " at screen 0.5, screen " + GnuplotNumber(1 - 38.0 / layout.height()) +
            " center textcolor '#111111'\n" + line(2, figures.data(), 71) +
            line(3,
                 "shown under the whole environment (" + EnvironmentOf(options).name + ")" +
                     exposed.data() +
                     (all_measured ? "" : "; grey: not measured, shown as what is next to it"),
                 34) +
            RowLabels(picture.rows, layout) + Separators(layout);
  const auto panel = [&](int index, const char* title, const Raster& raster) {
    script += std::string("set title '") + title + "' font ',22' offset 0,-0.3\n" +
              Place(raster, layout.PanelLeft(index), kTop, layout.size, layout.rows * layout.size,
                    layout) +
              "unset label\n";
  };
  panel(0, picture.measured, panels[0]);
  panel(1, "fitted", panels[1]);
  panel(2, "difference: below 1 unseen", panels[2]);
  script += "unset arrow\n" + ColorBar(layout);
  DrawPng(path, layout.width(), layout.height(), script);
}

constexpr int kPairMargin = 6, kPairBelow = 24;  // around each sphere, and for its word

// Below a picture, rows of the same width with a word in the middle.
void AddWord(Word word, Raster* raster) {
  const std::span<const std::string_view> rows = RowsOf(word);
  const int left = (raster->width - static_cast<int>(rows.front().size())) / 2;
  const int top = (kPairBelow - kWordRows) / 2 - 2;
  for (int y = 0; y < kPairBelow; ++y) {
    for (int x = 0; x < raster->width; ++x) {
      const bool within = y >= top && y < top + kWordRows && x >= left &&
                          x - left < static_cast<int>(rows.front().size());
      const double ink = within ? InkOf(rows[y - top][x - left]) : 0;
      for (const double c : kDarkBackground) {
        raster->bytes += Byte(std::lerp(EncodeSrgb(c), 0.9, ink));
      }
    }
  }
  raster->height += kPairBelow;
}

// The two beside each other, `size` pixels wide each, over their words if there are any.
Raster PairOf(const ImagePairs& images, int size, int margin, const PairWords* words) {
  const auto& [counted, whole] = images;
  const double exposure = ExposureOf(CompareSpheres(counted.measured, counted.fitted));
  Raster left = ToneMapped(whole.measured, size, exposure, margin);
  Raster right = ToneMapped(whole.fitted, size, exposure, margin);
  if (words != nullptr) {
    AddWord(words->left, &left);
    AddWord(words->right, &right);
  }
  const size_t row = static_cast<size_t>(left.width) * kChannels;
  Raster both{2 * left.width, left.height};
  for (size_t at = 0; at < left.bytes.size(); at += row) {
    both.bytes += left.bytes.substr(at, row) + right.bytes.substr(at, row);
  }
  return both;
}

void WriteImagePair(const ImagePairs& images, int size, const PairWords& words,
                    const std::string& path) {
  const Raster both = PairOf(images, size, kPairMargin, &words);
  WritePng(path, both.width, both.height, both.bytes);
}

// One alone, so many pixels wide, exposed by itself.
Raster ToneMappedAlone(const RenderedImage& image, int size, int margin = kMargin) {
  return ToneMapped(image, size, ExposureOf(CompareSpheres(image, image)), margin);
}

std::string PngOf(const Raster& raster) {
  return EncodePng(raster.width, raster.height, raster.bytes);
}

// Pixels of a picture over those of the sphere that fits are judged by; what is drawn is as large
// as a panel. Nodes take longer.
constexpr double kSizeOfTable = 2, kSizeOfNodes = 1.7, kSizeOfCloth = 1.25;

AppearanceOptions Enlarge(AppearanceOptions options, double times) {
  options.size = static_cast<int>(options.size * times);
  return options;
}

// Text on the sphere that fits are judged by.
std::string MeasureOf(const AppearanceOptions& options) {
  const std::string size = std::to_string(options.size);
  return size + " x " + size + " pixels under " + std::to_string(options.lights) +
         " points of the environment, as in the verdict";
}

constexpr char kAtNodes[] = "measured, between nodes as fitted";

SphereError ErrorOf(const ImagePair& pair) { return CompareSpheres(pair.measured, pair.fitted); }

}  // namespace

void DrawSpheres(const BrdfTable& measured, const AngularBrdf& fitted, const std::string& path,
                 const AppearanceOptions& options, const std::optional<SphereError>& error) {
  PairPicture picture{
      .source = measured.source,
      .rows = {},
      .error = error ? *error : ErrorOf(RenderMeasuredPair(measured, fitted, options)),
      .subject = MeasureOf(options),
      .images = {}};
  picture.images = RenderPicture(measured, fitted, Enlarge(options, kSizeOfTable));
  DrawImagePair(picture, options, path);
}

void DrawSpheres(const NodeBrdf& measured, const SphericalBrdf& fitted, const std::string& path,
                 const AppearanceOptions& options, const std::optional<SphereError>& error) {
  PairPicture picture{
      .source = measured.table().source,
      .rows = {},
      .error = error ? *error : ErrorOf(RenderMeasuredPair(measured, fitted, options)),
      .subject = MeasureOf(options),
      .images = {}};
  picture.measured = kAtNodes;
  picture.images = RenderPicture(measured, fitted, Shape::kSphere, Enlarge(options, kSizeOfNodes));
  DrawImagePair(picture, options, path);
}

void DrawFittedSphere(const Material& fitted, const std::string& path,
                      const AppearanceOptions& options) {
  const Raster alone = ToneMappedAlone(RenderPicture(fitted, Enlarge(options, kSizeOfTable)), 594);
  WritePng(path, alone.width, alone.height, alone.bytes);
}

void DrawCloth(const NodeBrdf& measured, const SphericalBrdf& fitted, const std::string& path,
               const AppearanceOptions& options) {
  PairPicture picture{
      .source = measured.table().source,
      .rows = {"light along the thread", "light across the thread"},
      .error = {},
      .subject = "this picture",
      .images = RenderPicture(measured, fitted, Shape::kCloth, Enlarge(options, kSizeOfCloth)),
      .measured = kAtNodes};
  picture.error = ErrorOf(picture.images.counted);
  DrawImagePair(picture, options, path);
}

void WriteSpherePair(const BrdfTable& measured, const AngularBrdf& fitted, const std::string& path,
                     const AppearanceOptions& options, const PairWords& words) {
  const int size = 2 * options.size;
  WriteImagePair(RenderPicture(measured, fitted, Enlarge(options, 2)), size, words, path);
}

std::string PngOfSpheres(const PictureData& measured, const Material& fitted,
                         const AppearanceOptions& options) {
  if (measured.empty()) {
    return PngOf(ToneMappedAlone(RenderPicture(fitted, options), options.size, 0));
  }
  const ImagePairs images =
      measured.nodes ? RenderPicture(*measured.nodes, fitted.spherical, Shape::kSphere, options)
                     : RenderPicture(*measured.table, fitted.angular, options);
  return PngOf(PairOf(images, options.size, 0, nullptr));
}

void WriteSpherePair(const PictureData& measured, const Material& fitted, const std::string& path,
                     const AppearanceOptions& options, const PairWords& words) {
  if (measured.nodes) {
    // Four times as many pixels would take four times as long, in a batch for each material.
    WriteImagePair(RenderPicture(*measured.nodes, fitted.spherical, Shape::kSphere, options),
                   2 * options.size, words, path);
  } else {
    CheckIsotropic(measured, fitted);
    WriteSpherePair(*measured.table, fitted.angular, path, options, words);
  }
}

}  // namespace trilobe
