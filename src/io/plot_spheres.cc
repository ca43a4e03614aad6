#include <utility>

#include "trilobe/io/plot_pair.h"
#include "trilobe/io/plots.h"

namespace trilobe {
namespace {

PairPicture SphereOf(const NodeBrdf& measured, const SphericalBrdf& fitted,
                     const AppearanceOptions& options) {
  ImagePairs pairs = RenderPairs(measured, fitted, Shape::kSphere, /*whole_too=*/true, options);
  return {.source = measured.table().source,
          .rows = {},
          .counted = std::move(pairs.counted),
          .whole = std::move(pairs.whole)};
}

}  // namespace

void DrawSpheres(const BrdfTable& measured, const AngularBrdf& fitted, const std::string& path,
                 AppearanceOptions options) {
  options.size = 320;
  PairPicture picture{.source = measured.source,
                      .rows = {},
                      .counted = RenderMeasuredPair(measured, fitted, options),
                      .whole = {}};
  picture.whole =
      measured.unmeasured.empty() ? picture.counted : RenderSpherePair(measured, fitted, options);
  DrawImagePair(picture, options, path);
}

void DrawSpheres(const NodeBrdf& measured, const SphericalBrdf& fitted, const std::string& path,
                 AppearanceOptions options) {
  options.size = 220;
  DrawImagePair(SphereOf(measured, fitted, options), options, path);
}

void DrawFittedSphere(const Material& fitted, const std::string& path, AppearanceOptions options) {
  options.size = 320;
  WriteImage(RenderSphere(fitted, options), path);
}

void DrawCloth(const NodeBrdf& measured, const SphericalBrdf& fitted, const std::string& path,
               AppearanceOptions options) {
  options.size = 160;
  ImagePairs pairs = RenderPairs(measured, fitted, Shape::kCloth, /*whole_too=*/true, options);
  DrawImagePair({.source = measured.table().source,
                 .rows = {"light along the thread", "light across the thread"},
                 .counted = std::move(pairs.counted),
                 .whole = std::move(pairs.whole)},
                options, path);
}

void WriteSpherePair(const BrdfTable& measured, const AngularBrdf& fitted, const std::string& path,
                     const AppearanceOptions& options) {
  WriteImagePair({.source = measured.source,
                  .rows = {},
                  .counted = RenderMeasuredPair(measured, fitted, options),
                  .whole = RenderSpherePair(measured, fitted, options)},
                 path);
}

void WriteSpherePair(const PictureData& measured, const Material& fitted, const std::string& path,
                     const AppearanceOptions& options) {
  if (measured.nodes) {
    WriteImagePair(SphereOf(*measured.nodes, fitted.spherical, options), path);
  } else {
    CheckIsotropic(measured, fitted);
    WriteSpherePair(*measured.table, fitted.angular, path, options);
  }
}

}  // namespace trilobe
