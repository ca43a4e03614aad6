#ifndef TRILOBE_IO_FORMATS_SPECTRUM_H_
#define TRILOBE_IO_FORMATS_SPECTRUM_H_

#include <array>
#include <span>
#include <vector>

#include "model/spectral_color.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// Adds a sample by its spectrum [1/sr], which is kept beside its colour. It is valid if all values
// are finite and >= 0. Channels below 0 (out of gamut) become 0.
void AddSpectrum(const SphericalAngles& angles, std::span<const double> spectrum,
                 const SpectralColor& color, SampleCollector* collector);

inline constexpr const char* kTristimulusNote = "X, Y, Z relative to white, which is taken for D65";
// The same for CIE 1931 tristimulus values, each relative to that of white: a grey has X = Y = Z.
// Their white is taken for D65.
void AddTristimulus(const SphericalAngles& angles, const std::array<double, 3>& xyz,
                    SampleCollector* collector);
// Such values of a colour in linear sRGB.
std::array<double, 3> TristimulusOf(const Rgb& rgb);

// Smooth spectra of colours (Jakob and Hanika, "A Low-Dimensional Function Space for Efficient
// Spectral Upsampling", 2019). With wavelengths mapped to t in [-1, 1],
//   r(t) = scale S(c0 t^2 + c1 t + c2),  S(x) = 1/2 + x / (2 sqrt(1 + x^2)).
// scale is twice the largest channel, since a BRDF may exceed 1; renderers treat unbounded colours
// alike. Greys become constant spectra, and c depends only on the chromaticity. c is fitted to the
// stored spectrum, which is linear between the wavelengths, so that few of them suffice.
class SmoothSpectra {
 public:
  // Throws Error as SpectralColor does.
  explicit SmoothSpectra(std::span<const double> wavelengths);

  // The spectrum of a colour at the wavelengths; channels below 0 count as 0. A colour that is too
  // saturated for such spectra is approximated, see error(). Starts from the coefficients of the
  // last call, which is fast for similar colours. Not thread-safe.
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
