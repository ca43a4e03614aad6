#ifndef TRILOBE_MODEL_MEASUREMENT_JOIN_SAMPLES_H_
#define TRILOBE_MODEL_MEASUREMENT_JOIN_SAMPLES_H_

#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// All samples of both, with a multiplicity each.
inline BrdfSamples JoinSamples(BrdfSamples samples, const BrdfSamples& added) {
  const size_t size = samples.rho.size() + added.rho.size();
  samples.multiplicity.reserve(size);
  samples.multiplicity.resize(samples.rho.size(), 1);
  const auto append = [&](const auto& from, auto* target) {
    if (!from.empty()) target->reserve(size);
    target->insert(target->end(), from.begin(), from.end());
  };
  append(added.angles, &samples.angles);
  append(added.directions, &samples.directions);
  append(added.rho, &samples.rho);
  append(added.multiplicity, &samples.multiplicity);
  samples.multiplicity.resize(size, 1);
  samples.spectra = nullptr;  // those added have none
  samples.spectrum_rows.clear();
  return samples;
}

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_JOIN_SAMPLES_H_
