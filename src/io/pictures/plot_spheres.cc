#include <utility>

#include "io/pictures/plot_pair.h"
#include "io/pictures/plots.h"

namespace trilobe {
namespace {

// Pixels of a picture over those of the sphere that fits are judged by; what is drawn is as large
// as a panel. Nodes take longer.
constexpr double kSizeOfTable = 2, kSizeOfNodes = 1.7, kSizeOfCloth = 1.25;

AppearanceOptions Larger(AppearanceOptions options, double times) {
  options.size = static_cast<int>(options.size * times);
  return options;
}

// Of the sphere that fits are judged by.
std::string MeasureOf(const AppearanceOptions& options) {
  const std::string size = std::to_string(options.size);
  return "a sphere of " + size + " x " + size + " pixels under " + std::to_string(options.lights) +
         " point lights";
}

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
  picture.images = RenderPicture(measured, fitted, Larger(options, kSizeOfTable));
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
  picture.images = RenderPicture(measured, fitted, Shape::kSphere, Larger(options, kSizeOfNodes));
  DrawImagePair(picture, options, path);
}

void DrawFittedSphere(const Material& fitted, const std::string& path,
                      const AppearanceOptions& options) {
  WriteImage(RenderPicture(fitted, Larger(options, kSizeOfTable)), 594, path);
}

void DrawCloth(const NodeBrdf& measured, const SphericalBrdf& fitted, const std::string& path,
               const AppearanceOptions& options) {
  PairPicture picture{
      .source = measured.table().source,
      .rows = {"light along the thread", "light across the thread"},
      .error = {},
      .subject = "this picture",
      .images = RenderPicture(measured, fitted, Shape::kCloth, Larger(options, kSizeOfCloth))};
  picture.error = ErrorOf(picture.images.counted);
  DrawImagePair(picture, options, path);
}

void WriteSpherePair(const BrdfTable& measured, const AngularBrdf& fitted, const std::string& path,
                     const AppearanceOptions& options) {
  WriteImagePair(RenderPicture(measured, fitted, options), path);
}

void WriteSpherePair(const PictureData& measured, const Material& fitted, const std::string& path,
                     const AppearanceOptions& options) {
  if (measured.nodes) {
    WriteImagePair(RenderPicture(*measured.nodes, fitted.spherical, Shape::kSphere, options), path);
  } else {
    CheckIsotropic(measured, fitted);
    WriteSpherePair(*measured.table, fitted.angular, path, options);
  }
}

}  // namespace trilobe
