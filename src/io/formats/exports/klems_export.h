#ifndef TRILOBE_IO_FORMATS_EXPORTS_KLEMS_EXPORT_H_
#define TRILOBE_IO_FORMATS_EXPORTS_KLEMS_EXPORT_H_

#include <string>
#include <vector>

#include "io/formats/exports/exported_brdf.h"

namespace trilobe {

// Means of a BRDF over pairs of patches of the full Klems basis [1/sr], each direction weighted by
// its projected solid angle, so that the reflected light is kept:
//   b[o][i] = integral of f cos theta_i cos theta_o d omega_i d omega_o over both patches
//             / (projected solid angle of i * that of o).
// The light of column i comes from the azimuth opposite to that of patch i. [145 * o + i]
// Outgoing directions are integrated over half vectors, so that highlights are resolved.
std::vector<Rgb> KlemsMeans(const ExportedBrdf& brdf, int num_threads);

// A BRDF as Radiance's and WINDOW's XML (docs/file-formats.md): these means, of the front and the
// back alike, as one matrix where all channels are the same, else X, Y and Z relative to white.
struct KlemsExport {
  std::string bytes;
  bool colored = false;
  double median_error = 0, high_error = 0;  // relative; high_error is the 99 % quantile
};
// `name` of the material is written as it is, escaped.
KlemsExport ExportKlems(const ExportedBrdf& brdf, const std::string& name, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_EXPORTS_KLEMS_EXPORT_H_
