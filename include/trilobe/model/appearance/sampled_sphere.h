#ifndef TRILOBE_MODEL_APPEARANCE_SAMPLED_SPHERE_H_
#define TRILOBE_MODEL_APPEARANCE_SAMPLED_SPHERE_H_

#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// The visible difference of a material and samples on no grid, on the sphere: noise and what is
// next to black weigh as little there as on any object. Samples are collected by cells of 7.5
// degrees of theta_i and theta_o and 15 degrees of azimuth. In each cell the measured material is
// the fitted one times the ratio of their sums over the samples, so that highlights keep their
// shape. Directions in cells without samples do not count; if that leaves less than half of the
// sphere, as of scans in a plane, each sample is a patch (CompareSamples).
// `values`: of the fitted material at the samples. `by_azimuth`: the samples are of an anisotropic
// material, with directions; else directions are exchanged and turned about the normal.
// The same bits for any number of threads. Throws Error if sizes differ or the environment is
// black.
SeenError CompareSampledSphere(const BrdfSamples& samples, const std::vector<Rgb>& values,
                               const SphericalBrdf& fitted, bool by_azimuth,
                               const AppearanceOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_SAMPLED_SPHERE_H_
