#ifndef TRILOBE_TESTS_MODEL_ANISOTROPIC_SAMPLES_H_
#define TRILOBE_TESTS_MODEL_ANISOTROPIC_SAMPLES_H_

#include <cmath>

#include "tests/test_util.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// Directions theta = 15 a, a < num_theta, by num_phi azimuths, each with each, as UTIA has them: a
// measurement without error of this model, or with log-normal errors.
inline BrdfSamples PolarSamples(const FactorModel& model, int num_theta, int num_phi,
                                double noise = 0, uint64_t seed = 1) {
  BrdfSamples samples;
  samples.source = "model";
  Random random(seed);
  const auto theta = [](int a) { return DegreesToRadians(15.0 * a); };
  const auto phi = [num_phi](int b) { return 2 * kPi * b / num_phi; };
  for (int i = 0; i < num_theta * num_phi; ++i) {
    for (int o = 0; o < num_theta * num_phi; ++o) {
      const SphericalAngles at = {theta(i / num_phi), phi(i % num_phi), theta(o / num_phi),
                                  phi(o % num_phi)};
      const SampleStencils stencils = ScatteredStencils(model.spec(), at);
      Rgb rho;
      for (int c = 0; c < kChannels; ++c) {
        rho[c] = UnclampedValue(model, stencils, c) * (noise > 0 ? random.LogNormal(noise) : 1);
      }
      samples.angles.push_back(ToHalfDiff(ToDirections(at)));
      samples.directions.push_back(at);
      samples.rho.push_back(rho);
    }
  }
  return samples;
}

inline BrdfSamples UtiaSamples(const FactorModel& model) { return PolarSamples(model, 6, 48); }

}  // namespace trilobe

#endif  // TRILOBE_TESTS_MODEL_ANISOTROPIC_SAMPLES_H_
