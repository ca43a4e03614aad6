#ifndef TRILOBE_IO_FORMATS_EXPORTS_ZEMAX_EXPORT_H_
#define TRILOBE_IO_FORMATS_EXPORTS_ZEMAX_EXPORT_H_

#include <optional>
#include <string>

#include "io/formats/exports/exported_brdf.h"

namespace trilobe {

struct ZemaxExportOptions {
  // Largest median relative error of rho cos theta_o, of what is linear between the angles of the
  // file. Angles are made denser until it is met. Default: 0.005, for anisotropic BRDFs 0.02, or as
  // near as files come. A given value that cannot be met is an Error.
  std::optional<double> max_error = {};
  int num_threads = 1;
};

// A BRDF as a table of Zemax OpticStudio (docs/file-formats.md), PlaneSymmetrical of an isotropic
// one, else Asymmetrical4D over SampleRotation; Monochrome where all channels are the same, else
// XYZ relative to white. Below the surface values are 0. TIS is the albedo, integrated finely.
struct ZemaxExport {
  std::string bytes;
  bool colored = false;
  int rotations = 1, incidences = 0, azimuths = 0, radials = 0;
  double median_error = 0, high_error = 0;  // relative; high_error is the 99 % quantile
};
ZemaxExport ExportZemax(const ExportedBrdf& brdf, const ZemaxExportOptions& options = {});

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_EXPORTS_ZEMAX_EXPORT_H_
