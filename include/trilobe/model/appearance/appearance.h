#ifndef TRILOBE_MODEL_APPEARANCE_APPEARANCE_H_
#define TRILOBE_MODEL_APPEARANCE_APPEARANCE_H_

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/appearance/albedo_error.h"
#include "trilobe/model/appearance/environment.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/appearance/point_errors.h"
#include "trilobe/model/appearance/render.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/measurement/albedo.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/measurement/node_brdf.h"

namespace trilobe {

// Visible difference of two spheres, over all pixels with coverage > 0 (RenderSpheres). Against a
// black measurement, every fitted pixel that is not black counts as white.
struct SphereError : SeenError {
  // |mean fitted - mean measured| / |mean measured|, linear RGB; 0 for a black measurement.
  double mean_color_error = 0;
  double exposure = 0;  // 0 for a black measurement
};
SphereError CompareSpheres(const RenderedImage& measured, const RenderedImage& fitted);

// The model at directions that were not measured.
struct BeyondData {
  double share = 0;  // unmeasured fraction of the bins above the surface
  // Largest rho cos theta, theta the steeper angle, outside and within the measured directions.
  double largest = 0, largest_within = 0;
  // PSNR over the whole sphere. Unmeasured bins take the authors' values or else the nearest valid
  // ones.
  double psnr_db = 0;
};

// Similarity of a material and its measurement.
struct AppearanceReport {
  std::string environment;
  int lights = 0, size = 0;
  SphereError sphere;
  AlbedoError albedo;
  // Errors at a subset of bin centres, and between them at bin corners; or at nodes and midway
  // between.
  PointErrors at_centers, between_centers;
  bool at_nodes = false;
  std::optional<BeyondData> beyond;  // nothing if all directions are measured
  // For synthetic materials: the errors of the fit and of the interpolated measurement against the
  // exact formula, on the sphere; and of the fit over all directions.
  struct FromFormula {
    SphereError fitted, measured, whole;
  };
  std::optional<FromFormula> from_formula = {};
};

struct AppearanceOptions {
  const Environment* environment = nullptr;  // null: StudioEnvironment()
  int lights = 600;                          // number of lights drawn from it
  int size = 96;                             // diameter of the sphere in pixels
  int num_threads = 1;
};

// The environment that is used.
const Environment& EnvironmentOf(const AppearanceOptions& options);

// Compares a material with a measurement, interpolated linearly between bin centres. Between nodes,
// which are far apart, the measured sphere differs from the fitted one by the factor that is
// interpolated linearly.
// `fitted` accepts any directions above the surface. The same bits for any number of threads.
// Throws Error if no bin is valid, the environment is black, or the material's values overflow.
AppearanceReport CompareAppearance(const BrdfTable& measured, const AngularBrdf& fitted,
                                   const AppearanceOptions& options);
AppearanceReport CompareAppearance(const NodeBrdf& measured, const SphericalBrdf& fitted,
                                   const AppearanceOptions& options,
                                   const BrdfFunction& formula = nullptr);

// Throws Error, naming the source, if a result overflows.
void CheckFinite(const AppearanceReport& report, const std::string& source);

// A fast version for comparing many materials with one measurement: the sphere error alone, on a
// quarter of the pixels, with the measured sphere rendered once.
class SphereJudge {
 public:
  // Throws Error if no bin is valid or the environment is black.
  SphereJudge(const BrdfTable& measured, const AppearanceOptions& options);
  // Compares all directions. Unmeasured bins have the values of the measurement's authors, or else
  // of the nearest valid bins (BeyondData::psnr_db).
  static SphereJudge OfAllDirections(const BrdfTable& measured, const AppearanceOptions& options);

  SphereError operator()(const AngularBrdf& fitted) const;

 private:
  SphereJudge(const BrdfTable& measured,
              std::function<bool(const HalfDiffAngles&, const Cosines&)> counts,
              const AppearanceOptions& options);
  RenderedImage Render(const AngularBrdf& brdf) const;

  const int size_, num_threads_;
  const std::vector<Light> lights_;
  const std::function<bool(const HalfDiffAngles&, const Cosines&)> counts_;
  const RenderedImage measured_;
};

// Two images; coverage is the fraction of the light from measured directions.
struct ImagePair {
  RenderedImage measured, fitted;
};
// The images that are compared: spheres under the lights drawn from the environment, for measured
// directions only.
ImagePair RenderMeasuredPair(const BrdfTable& measured, const AngularBrdf& fitted,
                             const AppearanceOptions& options);
ImagePair RenderMeasuredPair(const NodeBrdf& measured, const SphericalBrdf& fitted,
                             const AppearanceOptions& options);

// Images for display, under the full environment (RenderUnder): `counted` from measured directions
// only, `whole` from all, with the nearest bins or nodes in place of unmeasured ones.
struct ImagePairs {
  ImagePair counted, whole;
};
ImagePairs PairsOf(RenderedImages&& images);  // of two materials
ImagePairs RenderPicture(const BrdfTable& measured, const AngularBrdf& fitted,
                         const AppearanceOptions& options);
// On a sphere or on cloth (ViewCloth).
enum class Shape { kSphere, kCloth };
ImagePairs RenderPicture(const NodeBrdf& measured, const SphericalBrdf& fitted, Shape shape,
                         const AppearanceOptions& options);

// A single material on a sphere, for all directions.
RenderedImage RenderPicture(const Material& material, const AppearanceOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_APPEARANCE_H_
