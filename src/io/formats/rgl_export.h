#ifndef TRILOBE_IO_FORMATS_RGL_EXPORT_H_
#define TRILOBE_IO_FORMATS_RGL_EXPORT_H_

#include <optional>
#include <string>

#include "io/formats/completed_measurement.h"
#include "trilobe/core/math/angles.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

struct RglExportOptions {
  // What the file may be off by, relative, in the median over pairs of directions that are
  // distributed by their cosines, of rho cos theta_o. Finer tables are taken until it is met.
  // 0.005 if it is not given, of anisotropic models 0.02, or where no table is that near, hardly
  // worse than the nearest; what is given and cannot be met is an Error.
  std::optional<double> max_error = {};
  // Pairs with a direction further than this from the normal do not count [rad]: beyond what was
  // measured, a model says little, and may say it with any contrast.
  double max_theta = kPi / 2;
  // For spectral renderers: `spectra` at some `wavelengths` in place of `rgb` (SmoothSpectra).
  bool spectral = false;
};

// A material as an RGL tensor file (Dupuy and Jakob 2018), which renderers read: Mitsuba 3
// (`measured`, in variants with RGB colours) and powitacq_rgb, or, with `spectral`, Mitsuba's
// spectral variants and pbrt-v4. docs/renderers.md says how the model becomes its tables.
struct RglExport {
  std::string bytes;
  int theta_i = 0, phi_i = 1, resolution = 0;  // nodes, and rows and columns of values
  double median_error = 0, high_error = 0;     // relative; the latter is the 99 % quantile
  // With `spectral`: by how much colours of the spectra are off those that they stand for, before
  // anything is interpolated, relative; at most, and the share that is off by more than 0.001.
  double color_error = 0, colors_off = 0;
};

// Throws Error if no file of at most 18 MB (by `rgb`; spectra take five times as much) is exact
// enough, with the error of the last one.
RglExport ExportRgl(const FactorModel& model, const RglExportOptions& options = {});

// A measurement, by help of a model that was fitted to it: the warp is the model's, the values are
// those measured (Complete), and so are the places by which the error is judged. Measurements have
// noise, which finer tables follow late or never: without max_error it is the smallest file that
// does as the model's would, or else hardly worse than the best of those of usual size, 2.2 MB, of
// anisotropic ones 12.
RglExport ExportRgl(const FactorModel& model, const CompletedMeasurement& measured,
                    const RglExportOptions& options = {});

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_RGL_EXPORT_H_
