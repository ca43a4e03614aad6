#ifndef TRILOBE_IO_FORMATS_SPECTRUM_H_
#define TRILOBE_IO_FORMATS_SPECTRUM_H_

#include <array>
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

// A smooth spectrum of each colour (Jakob and Hanika, "A Low-Dimensional Function Space for
// Efficient Spectral Upsampling", 2019): at the wavelength that t stands for, from -1 to 1,
//   r(t) = scale S(c0 t^2 + c1 t + c2),  S(x) = 1/2 + x / (2 sqrt(1 + x^2)).
// A BRDF may exceed 1, so the scale is twice the largest channel, as renderers scale colours that
// have no bound; then greys are constant spectra, and c depends on the chromaticity alone. c is
// found for the spectrum as it is stored, linear between the wavelengths, so that few of them do.
class SmoothSpectra {
 public:
  // Throws Error as SpectralColor does.
  explicit SmoothSpectra(std::span<const double> wavelengths);

  // The spectrum of a colour >= 0 (a channel below 0 counts as 0), at the wavelengths. Its colour,
  // of which Error is, is the colour asked for, but where that is more saturated than such
  // spectra can be: then one near it. Begins where the last call ended, which is quick where
  // colours change little from one to the next; not for several threads.
  std::span<const double> operator()(const Rgb& rgb);

  // |colour of the last spectrum - colour asked for| / |colour asked for|.
  double error() const { return error_; }

 private:
  using Coefficients = std::array<double, 3>;
  Rgb ColorOf(const Coefficients& c);
  double Solve(const Rgb& target, Coefficients* c);

  SpectralColor color_;
  std::vector<double> t_;           // [wavelengths]
  std::vector<double> spectrum_;    // [wavelengths]
  std::vector<double> derivative_;  // of S [wavelengths]
  Coefficients last_{};
  double error_ = 0;
};

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_SPECTRUM_H_
