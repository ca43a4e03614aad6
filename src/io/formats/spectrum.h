#ifndef TRILOBE_IO_FORMATS_SPECTRUM_H_
#define TRILOBE_IO_FORMATS_SPECTRUM_H_

#include <span>
#include <string>
#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// What linear sRGB sees of a reflectance spectrum: the CIE 1931 2-degree observer under D65, whose
// white is that of sRGB, so that a constant spectrum r becomes (r, r, r) without any adaptation.
class SpectralColor {
 public:
  // Ascending wavelengths [nm]. Between them a spectrum is taken as linear, and beyond them as
  // constant, which adds the weights there to the ends (ASTM E308). Throws Error, which names the
  // source, where they do not ascend or leave much of the visible out: each gap must be 50 nm or
  // less, and so must what is missing from 400 to 700 nm at both ends.
  SpectralColor(std::span<const double> wavelengths, const std::string& source);

  // [wavelengths]; a channel is below 0 where sRGB cannot show the colour.
  Rgb operator()(std::span<const double> spectrum) const;

 private:
  std::vector<Rgb> weights_;  // [wavelengths]
};

// Adds a sample by its spectrum [1/sr]. It is valid if all values are finite and >= 0; channels
// below 0 come from the gamut alone, and become 0.
void AddSpectrum(const SphericalAngles& angles, std::span<const double> spectrum,
                 const SpectralColor& color, SampleCollector* collector);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_SPECTRUM_H_
