#include "io/formats/text/spectra_of_rows.h"

#include <algorithm>
#include <limits>

namespace trilobe {

bool SpectraOfRows::Add(const SphericalAngles& at, double wavelength, double value) {
  wavelengths_.insert(wavelength);
  if (wavelengths_.size() > kMostWavelengths) return false;
  const auto [found, is_new] =
      last_.try_emplace({at.theta_i, at.phi_i, at.theta_o, at.phi_o}, samples_.size());
  size_t& last = found->second;
  const auto has_wavelength = [&](const Sample& sample) {
    return std::ranges::any_of(sample.values,
                               [&](const auto& one) { return one.first == wavelength; });
  };
  if (is_new || has_wavelength(samples_[last])) {
    last = samples_.size();
    samples_.push_back({.at = at});
  }
  samples_[last].values.emplace_back(wavelength, value);
  return true;
}

std::vector<double> SpectraOfRows::wavelengths() const {
  return {wavelengths_.begin(), wavelengths_.end()};
}

void SpectraOfRows::AddTo(SpectrumBands* bands, SampleCollector* collector) const {
  const std::vector<double> all = wavelengths();
  std::vector<double> spectrum(all.size());
  for (const Sample& sample : samples_) {
    std::ranges::fill(spectrum, std::numeric_limits<double>::quiet_NaN());
    for (const auto& [wavelength, value] : sample.values) {
      spectrum[std::ranges::lower_bound(all, wavelength) - all.begin()] = value;
    }
    bands->Add(sample.at, spectrum, collector, /*nan_is_gap=*/true);
  }
}

}  // namespace trilobe
