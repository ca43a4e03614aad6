#ifndef TRILOBE_APPEARANCE_SPHERE_H_
#define TRILOBE_APPEARANCE_SPHERE_H_

#include <functional>
#include <span>
#include <vector>

#include "trilobe/appearance/environment.h"
#include "trilobe/brdf/channels.h"
#include "trilobe/brdf/directions.h"
#include "trilobe/brdf/tabulated_brdf.h"

namespace trilobe {

// BRDF [1/sr] of an isotropic material for two directions above the surface, by their angles.
using AngularBrdf = std::function<Rgb(const HalfDiffAngles&, const Cosines&)>;

// A measurement, linear between bin centres. Keeps a reference to `table`.
AngularBrdf Interpolated(const TabulatedBrdf& table);

// Radiance of a sphere seen from afar, without shadows and reflections of itself.
struct SphereImage {
  int size = 0;                  // pixels along each side; the sphere touches the sides
  std::vector<Rgb> radiance;     // [size^2], row by row from the top; 0 off the sphere
  std::vector<double> coverage;  // [size^2], the share of the light on a pixel that counts; below 0
                                 // off the sphere
};

// One sphere a material, all under the same lights. What a pixel shows is the light along its
// middle. Pairs of directions for which `counts` is false are left out of all spheres. The same
// bits for any number of threads.
std::vector<SphereImage> RenderSpheres(
    std::span<const AngularBrdf> materials, std::span<const Light> lights, int size,
    const std::function<bool(const HalfDiffAngles&, const Cosines&)>& counts, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_APPEARANCE_SPHERE_H_
