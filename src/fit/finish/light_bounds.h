#ifndef TRILOBE_FIT_FINISH_LIGHT_BOUNDS_H_
#define TRILOBE_FIT_FINISH_LIGHT_BOUNDS_H_

#include <cstddef>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// The share of the light from a direction that may be reflected, by channel.
struct LightBound {
  PolarAngles at;  // [rad]
  Rgb limit;
};

// The largest directional albedo of a model over directions and channels.
struct PeakAlbedo {
  double albedo = 0, theta_i = 0;  // [rad]
};

// The directional albedos of a model, isotropic or not, from the directions of bounds, by the rule
// of DirectionalAlbedo.
std::vector<Rgb> AlbedosFrom(const std::vector<LightBound>& bounds, const FactorModel& model,
                             int num_threads);

// By how much an albedo exceeds its limit at most: A / limit over the channels. Up to
// 1 + kLightTolerance it keeps to it.
inline constexpr double kLightTolerance = 1e-3;
double ExcessOf(const Rgb& albedo, const Rgb& limit);

// Which of these bounds a model may exceed by more than `by`, at a quick look. Ascending.
std::vector<size_t> MayExceed(const std::vector<LightBound>& bounds, double by,
                              const FactorModel& model, int num_threads);

// Each half degree of theta up to 89.5 degrees and, of an anisotropic model, each 5 degrees of
// azimuth where its directional albedo exceeds the limit, or some of many. All are looked at
// quickly: by fewer azimuths of half vectors and, of an anisotropic model, by lobes, which reflect
//   A_m(theta, phi) = K_m(theta, phi) G_m(theta, phi) / cos theta,
// with the smooth K_m interpolated. Those that may exceed are looked at well, some hundreds at a
// time; as soon as some do, these stand for all. Of thousands, which a limit that holds everywhere
// leaves near it, one in some and those that are largest by lobes are looked at. The same bits for
// any number of threads.
std::vector<LightBound> ExceededBounds(const Rgb& limit, const FactorModel& model, int num_threads);

// The largest directional albedo of an anisotropic model there: of those that are largest at a
// quick look.
PeakAlbedo PeakOfLookedAt(const FactorModel& model, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_LIGHT_BOUNDS_H_
