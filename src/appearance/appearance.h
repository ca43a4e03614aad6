#ifndef TRILOBE_APPEARANCE_APPEARANCE_H_
#define TRILOBE_APPEARANCE_APPEARANCE_H_

#include <optional>
#include <string>
#include <vector>

#include "trilobe/appearance/environment.h"
#include "trilobe/appearance/sphere.h"
#include "trilobe/brdf/brdf_table.h"
#include "trilobe/brdf/channels.h"

namespace trilobe {

// How two spheres differ to the eye. Both get the exposure that takes the mean luminance of the
// measured one to kMeanLuminance, are clipped at 1 and encoded by the sRGB curve. All pixels of the
// sphere count on which any light counts (RenderSpheres). Beside a black measurement, whatever is
// not black is white.
inline constexpr double kMeanLuminance = 0.35;
struct SphereError {
  double psnr_db = 0;       // of the encoded values, peak 1; +infinity for equal pictures
  double mean_delta_e = 0;  // CIELAB, 1976
  double delta_e_95 = 0;    // 95 % of the pixels stay below
  // |mean fitted - mean measured| / |mean measured|, linear RGB; 0 for a black measurement.
  double mean_color_error = 0;
  double exposure = 0;  // 0 for a black measurement
};
SphereError CompareSpheres(const SphereImage& measured, const SphereImage& fitted);

// Directional albedos over theta_i, of what is measured alone.
struct AlbedoError {
  std::vector<double> theta_i;        // [rad]
  std::vector<Rgb> measured, fitted;  // [theta_i.size()]
  double mean = 0, max = 0;           // of |fitted - measured|, over angles and channels
};

// Mean over points and channels of |log((1 + b) / (1 + b*))|, b = rho cos theta_i, and of
// |rho - rho*| / (rho* + 1e-3).
struct PointErrors {
  double log = 0, relative = 0;
};

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
  PointErrors at_centers, between_centers;  // of every few bins; between: at their corners
  std::optional<BeyondData> beyond;         // nothing where the measurement covers all directions
};

struct AppearanceOptions {
  const Environment* environment = nullptr;  // null: StudioEnvironment()
  int lights = 600;                          // drawn from it
  int size = 96;                             // of the sphere, in pixels
  int num_threads = 1;
};

// Compares a material with a measurement, which is linear between bin centres. `fitted` is a
// function of any two directions. The same bits for any number of threads. Throws Error when no bin
// is valid, the environment is black, or the material's values overflow.
AppearanceReport CompareAppearance(const BrdfTable& measured, const AngularBrdf& fitted,
                                   const AppearanceOptions& options);

// The part of it that says most, for comparing many materials with one measurement.
SphereError CompareOnSphere(const BrdfTable& measured, const AngularBrdf& fitted,
                            const AppearanceOptions& options);

// Measured and fitted sphere under an environment: as they are compared, from measured directions
// alone, and, for pictures, from all.
struct SpherePair {
  SphereImage measured, fitted;  // coverage: the share of the light whose directions were measured
};
SpherePair RenderMeasuredPair(const BrdfTable& measured, const AngularBrdf& fitted,
                              const AppearanceOptions& options);
SpherePair RenderSpherePair(const BrdfTable& measured, const AngularBrdf& fitted,
                            const AppearanceOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_APPEARANCE_APPEARANCE_H_
