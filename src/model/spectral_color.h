#ifndef TRILOBE_MODEL_SPECTRAL_COLOR_H_
#define TRILOBE_MODEL_SPECTRAL_COLOR_H_

#include <span>
#include <string>
#include <vector>

#include "trilobe/core/base/channels.h"

namespace trilobe {

// Matrix from XYZ to linear sRGB (IEC 61966-2-1).
inline constexpr double kToSrgb[kChannels][3] = {{3.2404542, -1.5371385, -0.4985314},
                                                 {-0.9692660, 1.8760108, 0.0415560},
                                                 {0.0556434, -0.2040259, 1.0572252}};

// XYZ of its white, D65.
inline constexpr double kWhite[] = {0.95047, 1, 1.08883};

// Converts reflectance spectra to linear sRGB: CIE 1931 2-degree observer under D65, the white of
// sRGB. A constant spectrum r becomes (r, r, r) without adaptation.
class SpectralColor {
 public:
  // Ascending wavelengths [nm]. Spectra are linear between them and constant beyond them (ASTM
  // E308). Throws Error, which names the source, if they do not ascend, a gap exceeds 50 nm, or
  // more than 50 nm of 400 to 700 nm is missing at an end.
  SpectralColor(std::span<const double> wavelengths, const std::string& source);

  // The same, but of one wavelength alone, wherever it is: its value is that of all channels.
  static SpectralColor OfBands(std::span<const double> wavelengths, const std::string& source);

  const std::vector<double>& wavelengths() const { return wavelengths_; }
  // Contribution of a unit of each wavelength to the colour; may be below 0. [wavelengths]
  const std::vector<Rgb>& weights() const { return weights_; }

  // spectrum: [wavelengths]. Channels are below 0 for colours outside the gamut of sRGB.
  Rgb operator()(std::span<const double> spectrum) const;

 private:
  SpectralColor() = default;
  std::vector<double> wavelengths_;
  std::vector<Rgb> weights_;  // [wavelengths]
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_SPECTRAL_COLOR_H_
