#ifndef TRILOBE_TESTS_MODEL_SPECTRAL_MATERIALS_H_
#define TRILOBE_TESTS_MODEL_SPECTRAL_MATERIALS_H_

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "model/spectral_color.h"
#include "tests/model/materials.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/spectral_model.h"

namespace trilobe {

// `count` wavelengths from 400 to 700 nm.
inline std::vector<double> VisibleWavelengths(int count) {
  std::vector<double> wavelengths;
  for (int l = 0; l < count; ++l) wavelengths.push_back(400 + 300.0 * l / (count - 1));
  return wavelengths;
}

// D and G of AnalyticModel; d, s and F change smoothly with the wavelength, F by lobe if the spec
// has one for each.
inline SpectralModel AnalyticSpectralModel(const ModelSpec& spec, std::vector<double> wavelengths) {
  const FactorModel model = AnalyticModel(spec, 0.2, 0.3);
  SpectralModel spectral(spec, std::move(wavelengths));
  for (const Factor factor : {Factor::kD, Factor::kG}) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      std::ranges::copy(model.table(factor, t), spectral.table(factor, t).begin());
    }
  }
  for (int l = 0; l < spectral.bands(); ++l) {
    const double x = (spectral.wavelengths()[l] - 550) / 150;
    spectral.d()[l] = 0.1 + 0.05 * std::sin(2 * x);
    for (int m = 0; m < spec.lobes; ++m) {
      spectral.s(m)[l] = 0.2 / (1 + m) * (1 + 0.4 * std::cos(3 * x + m));
      const std::span<double> F = spectral.F(m, l);
      const double tint = spec.F.per_channel ? 0.2 * x : 0, own = spec.F.per_lobe ? 0.1 * m : 0;
      for (size_t k = 0; k < F.size(); ++k) {
        F[k] = 1 + tint + own * std::pow(static_cast<double>(k) / static_cast<double>(F.size()), 3);
      }
    }
  }
  return spectral;
}

// Readings of a spectrometer at `count` pairs of directions, off by log-normal noise.
inline Measurement MeasureSpectra(const SpectralModel& model, int count, double noise = 0) {
  const SpectralColor color = SpectralColor::OfBands(model.wavelengths(), "the material");
  SampleCollector collector("the material", "spectra");
  Random random(1);
  for (int j = 0; j < count; ++j) {
    const SphericalAngles at = {random.Uniform(0, 1.3), random.Uniform(0, 6),
                                random.Uniform(0, 1.3), random.Uniform(0, 6)};
    std::vector<double> spectrum = Evaluate(model, ToDirections(at));
    for (double& x : spectrum) x *= noise > 0 ? random.LogNormal(noise) : 1;
    collector.AddColor(at, color(spectrum));
    collector.KeepSpectrum(model.wavelengths(), spectrum);
  }
  return collector.TakeByAzimuths();
}

}  // namespace trilobe

#endif  // TRILOBE_TESTS_MODEL_SPECTRAL_MATERIALS_H_
