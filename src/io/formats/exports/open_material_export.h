#ifndef TRILOBE_IO_FORMATS_EXPORTS_OPEN_MATERIAL_EXPORT_H_
#define TRILOBE_IO_FORMATS_EXPORTS_OPEN_MATERIAL_EXPORT_H_

#include <string>

#include "io/formats/exports/exported_brdf.h"

namespace trilobe {

// An isotropic BRDF as a table of ASAM OpenMATERIAL 3D, schema `material_brdf` 1.1.0
// (docs/file-formats.md): at 550 nm where all channels are the same, else at 7 wavelengths from
// 400 to 700 nm (SmoothSpectra). It has the fewest angles with which linear interpolation, and
// colours by CIE 1931, are off by at most 0.5 % in the median, or hardly worse than with more.
struct OpenMaterialExport {
  std::string bytes;
  bool colored = false;
  int incidences = 0, zeniths = 0, azimuths = 0;
  double median_error = 0, high_error = 0;  // relative; high_error is the 99 % quantile
};
// `name` is the material's. Throws Error for an anisotropic BRDF: rows have no azimuth of the
// light.
OpenMaterialExport ExportOpenMaterial(const ExportedBrdf& brdf, const std::string& name,
                                      int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_EXPORTS_OPEN_MATERIAL_EXPORT_H_
