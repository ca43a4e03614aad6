#ifndef TRILOBE_FIT_FIT_BANDS_H_
#define TRILOBE_FIT_FIT_BANDS_H_

#include <string>
#include <vector>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/spectral_model.h"

namespace trilobe {

// A model of all wavelengths that a measurement has, and its errors.
struct BandsFit {
  SpectralModel model;
  // E of each band, sum_j w_j (rho_l(j) - rho*_l(j))^2, and that of a black model. A sample weighs
  // the same in all bands: the mean of its weights in R, G and B. [bands]
  std::vector<double> objective, black;

  // objective / black; 0 where that is 0.
  double Relative(int band) const { return black[band] > 0 ? objective[band] / black[band] : 0; }
};

// Throws Error, which names the `source`, if the samples have no spectra, or the spec's D or G
// differ by channel.
void CheckBands(const std::string& source, const BrdfSamples& samples, const ModelSpec& spec);

// The objective of the wavelengths of a measurement: of all samples or, of a table, of those that
// have spectra and are fitted with the values that they were read with. Throws Error if there are
// none.
Objective WithSpectra(const Objective& data, const Measurement& measurement);

// Fits d, s and F of each band, with D and G held as they are in `rgb`, a model of the objective's
// spec that was fitted to the colours of the same samples. E of a band is then a quadratic function
// of d and s F: one pass over the samples sums its coefficients, and damped Gauss-Newton steps in
// d, s and F, all >= 0, from the F of each channel of `rgb`, find its minimum. Where no sample
// reads F, it goes on as the mean F of `rgb` does. Each F has the scale of the canonical form: the
// lobes that read it reflect 4 s together. F that `rgb` shares by its channels is held, too.
// Deterministic, for any number of threads.
//
// Throws Error as CheckBands does.
BandsFit FitBands(const Objective& objective, const FactorModel& rgb, const StopCheck& stop = {});

}  // namespace trilobe

#endif  // TRILOBE_FIT_FIT_BANDS_H_
