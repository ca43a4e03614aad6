#include "fit/samples_to_fit.h"

#include <utility>

#include "model/measurement/sample_density.h"

namespace trilobe {

BrdfSamples SamplesToFit(const Measurement& measurement, const SelectSamples& select) {
  BrdfSamples samples = SamplesOf(measurement);
  return select ? select(std::move(samples)) : samples;
}

std::shared_ptr<const BrdfSamples> SharedSamplesToFit(const Measurement& measurement,
                                                      const SelectSamples& select) {
  const BrdfSamples& own = measurement.samples;
  const bool all_own = !measurement.table && !select && own.size() > 0;
  if (all_own && (measurement.anisotropic || EvenMultiplicity(own) == own.multiplicity)) {
    return {std::shared_ptr<const BrdfSamples>(), &own};
  }
  return std::make_shared<const BrdfSamples>(SamplesToFit(measurement, select));
}

}  // namespace trilobe
