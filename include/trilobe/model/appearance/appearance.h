#ifndef TRILOBE_MODEL_APPEARANCE_APPEARANCE_H_
#define TRILOBE_MODEL_APPEARANCE_APPEARANCE_H_

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/directions.h"
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

// How two spheres differ to the eye. All pixels of the sphere count on which any light counts
// (RenderSpheres). Beside a black measurement, whatever is not black is white.
struct SphereError : SeenError {
  // |mean fitted - mean measured| / |mean measured|, linear RGB; 0 for a black measurement.
  double mean_color_error = 0;
  double exposure = 0;  // 0 for a black measurement
};
SphereError CompareSpheres(const RenderedImage& measured, const RenderedImage& fitted);

// What the model makes of directions that were not measured.
struct BeyondData {
  double share = 0;  // of the bins above the surface that are not measured
  // The largest rho cos theta, theta the steeper of the two angles, there and where data are.
  double largest = 0, largest_within = 0;
  double psnr_db = 0;  // of the whole sphere, against the measurement extended by whoever made it,
                       // or else by its nearest valid bins
};

// How like its measurement a material looks.
struct AppearanceReport {
  std::string environment;
  int lights = 0, size = 0;
  SphereError sphere;
  AlbedoError albedo;
  // Of every few bins; between: at their corners. Or at nodes, and in the middle between them.
  PointErrors at_centers, between_centers;
  bool at_nodes = false;
  std::optional<BeyondData> beyond;  // nothing where the measurement covers all directions
  // Where it is known what was measured, a synthetic material: how far from that, on the sphere,
  // are the fit and the measurement itself, interpolated.
  struct FromFormula {
    SphereError fitted, measured;
  };
  std::optional<FromFormula> from_formula = {};
};

struct AppearanceOptions {
  const Environment* environment = nullptr;  // null: StudioEnvironment()
  int lights = 600;                          // drawn from it
  int size = 96;                             // of the sphere, in pixels
  int num_threads = 1;
};

// What they are lit by.
const Environment& EnvironmentOf(const AppearanceOptions& options);

// Compares a material with a measurement, which is linear between bin centres, or between nodes.
// `fitted` is a function of any two directions. The same bits for any number of threads. Throws
// Error when no bin is valid, the environment is black, or the material's values overflow.
AppearanceReport CompareAppearance(const BrdfTable& measured, const AngularBrdf& fitted,
                                   const AppearanceOptions& options);
AppearanceReport CompareAppearance(const NodeBrdf& measured, const SphericalBrdf& fitted,
                                   const AppearanceOptions& options,
                                   const BrdfFunction& formula = nullptr);

// Throws Error, which names the source, where a figure overflows.
void CheckFinite(const AppearanceReport& report, const std::string& source);

// The part of it that says most, for comparing many materials with one measurement, whose sphere is
// rendered once: on a quarter of the pixels, which tells them apart in a quarter of the time.
class SphereJudge {
 public:
  // Throws Error when no bin is valid or the environment is black.
  SphereJudge(const BrdfTable& measured, const AppearanceOptions& options);
  // Looks at all directions: at what whoever made the measurement took for those that it lacks, or
  // else at its nearest valid bins (BeyondData::psnr_db).
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

// Two images, whose coverage is the share of the light whose directions were measured.
struct ImagePair {
  RenderedImage measured, fitted;
};
// The pair that is compared: a sphere under the points that stand for the environment, from
// measured directions alone.
ImagePair RenderMeasuredPair(const BrdfTable& measured, const AngularBrdf& fitted,
                             const AppearanceOptions& options);
ImagePair RenderMeasuredPair(const NodeBrdf& measured, const SphericalBrdf& fitted,
                             const AppearanceOptions& options);

// What pictures show, under the environment itself (RenderUnder): from measured directions alone,
// and from all; the nearest bins or nodes stand for those that were not measured.
struct ImagePairs {
  ImagePair counted, whole;
};
ImagePairs PairsOf(RenderedImages&& images);  // of two materials
ImagePairs RenderPicture(const BrdfTable& measured, const AngularBrdf& fitted,
                         const AppearanceOptions& options);
// On a sphere, or on cloth (ViewCloth).
enum class Shape { kSphere, kCloth };
ImagePairs RenderPicture(const NodeBrdf& measured, const SphericalBrdf& fitted, Shape shape,
                         const AppearanceOptions& options);

// A material alone on a sphere, from all directions.
RenderedImage RenderPicture(const Material& material, const AppearanceOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_APPEARANCE_H_
