#ifndef TRILOBE_IO_FORMATS_EXPORTS_RGL_EXPORT_H_
#define TRILOBE_IO_FORMATS_EXPORTS_RGL_EXPORT_H_

#include <optional>
#include <string>

#include "io/formats/completed_measurement.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/spectral_model.h"

namespace trilobe {

struct RglExportOptions {
  // Largest median relative error of rho cos theta_o over pairs of directions distributed by their
  // cosines. Tables are refined until it is met. Default: 0.005, for anisotropic models 0.02; if no
  // table meets the default, one hardly worse than the best. A given value that cannot be met is an
  // Error.
  std::optional<double> max_error = {};
  // Pairs with a direction farther than this from the normal do not count [rad], because a model is
  // unreliable beyond the measured directions.
  double max_theta = kPi / 2;
  // Writes `spectra` at some `wavelengths` instead of `rgb` (SmoothSpectra).
  bool spectral = false;
};

// A material as an RGL tensor file (Dupuy and Jakob 2018). Readers: Mitsuba 3 (`measured`, RGB
// variants) and powitacq_rgb; with `spectral`, Mitsuba's spectral variants and pbrt-v4. See
// docs/rendering.md.
struct RglExport {
  std::string bytes;
  int theta_i = 0, phi_i = 1, resolution = 0;  // nodes; rows and columns of values
  double median_error = 0, high_error = 0;     // relative; high_error is the 99 % quantile
  // Relative colour error of the spectra before interpolation, with `spectral`: its maximum, and
  // the fraction of colours with more than 0.001.
  double color_error = 0, colors_off = 0;
};

// Throws Error, with the last error, if no file of at most 18 MB (with `rgb`; spectra take five
// times as much) is exact enough.
RglExport ExportRgl(const FactorModel& model, const RglExportOptions& options = {});

// The same of a spectral model, with its own wavelengths and values, and the error of its colours.
// `options.spectral` does not count. Throws Error for a single wavelength, too.
RglExport ExportRgl(const SpectralModel& model, const RglExportOptions& options = {});

// Exports a measurement with the warp of a model fitted to it. The values, and the places where
// the error is measured, are those of Complete. Noise limits the accuracy of finer tables, so
// without max_error this returns the smallest file that meets the model's default error, or else
// one hardly worse than the best of usual size (2.2 MB; anisotropic 12 MB).
RglExport ExportRgl(const FactorModel& model, const CompletedMeasurement& measured,
                    const RglExportOptions& options = {});

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_EXPORTS_RGL_EXPORT_H_
