#ifndef TRILOBE_IO_FORMATS_SPECTRUM_BANDS_H_
#define TRILOBE_IO_FORMATS_SPECTRUM_BANDS_H_

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/spectral_color.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// The wavelengths [nm] that --bands names, "450,550,650", ascending; none of "". Throws Error
// unless it is one, or three or more that differ.
std::vector<double> ParseBands(std::string_view bands);

// The wavelengths of spectra that are read, and the colour that they make: all; one alone, for all
// channels; three as r, g, b, the longest as r; or several, as if there were no others.
class SpectrumBands {
 public:
  // wavelengths: [nm], of the file; `chosen`: SourceOptions::bands. Throws Error, which names the
  // source, where a chosen one is not there, and as SpectralColor does.
  SpectrumBands(std::span<const double> wavelengths, std::string_view chosen,
                const std::string& source);

  int all() const { return static_cast<int>(all_); }  // of the file
  // Indices of the wavelengths that are read. [read]
  const std::vector<size_t>& read() const { return read_; }
  // Three are r, g and b, and no spectrum is kept.
  bool are_channels() const { return !color_.has_value(); }

  // spectrum: [wavelengths], [1/sr]. Channels are below 0 for colours outside the gamut of sRGB.
  Rgb ColorOf(std::span<const double> spectrum);
  // Adds a sample by its spectrum, which is kept beside its colour; valid if all values that are
  // read are finite and >= 0. Channels below 0 (out of gamut) become 0. One with a NaN is missing
  // if `nan_is_gap`.
  void Add(const SphericalAngles& angles, std::span<const double> spectrum,
           SampleCollector* collector, bool nan_is_gap = false);

  // Text such as "7 wavelengths to RGB by CIE 1931 (--bands picks some)", or "532 nm".
  std::string Note() const;

 private:
  // The part of `spectrum` that is read; valid until the next call.
  std::span<const double> Read(std::span<const double> spectrum);

  size_t all_;
  std::vector<size_t> read_;
  std::optional<SpectralColor> color_;
  std::string names_;        // "650, 550, 450 nm" of up to three
  std::vector<double> row_;  // of one sample
};

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_SPECTRUM_BANDS_H_
