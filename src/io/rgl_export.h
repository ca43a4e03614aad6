#ifndef TRILOBE_IO_RGL_EXPORT_H_
#define TRILOBE_IO_RGL_EXPORT_H_

#include <optional>
#include <string>

#include "trilobe/math/angles.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

struct RglExportOptions {
  // What the file may be off by, relative, in the median over pairs of directions that are
  // distributed by their cosines, of rho cos theta_o. Finer tables are taken until it is met.
  // 0.005 if it is not given, of anisotropic models 0.02.
  std::optional<double> max_error = {};
  // Pairs with a direction further than this from the normal do not count [rad]: beyond what was
  // measured, a model says little, and may say it with any contrast.
  double max_theta = kPi / 2;
};

// A model as an RGL tensor file (Dupuy and Jakob 2018), which Mitsuba 3 (`measured`, in variants
// with RGB colours) and powitacq_rgb read: docs/rendering.md says how the model becomes its tables.
struct RglExport {
  std::string bytes;
  int theta_i = 0, phi_i = 1, resolution = 0;  // nodes, and rows and columns of values
  double median_error = 0, high_error = 0;     // relative; the latter is the 99 % quantile
};

// Throws Error if no file of at most 18 MB is exact enough, with the error of the last one.
RglExport ExportRgl(const FactorModel& model, const RglExportOptions& options = {});

}  // namespace trilobe

#endif  // TRILOBE_IO_RGL_EXPORT_H_
