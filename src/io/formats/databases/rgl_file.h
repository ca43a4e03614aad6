#ifndef TRILOBE_IO_FORMATS_DATABASES_RGL_FILE_H_
#define TRILOBE_IO_FORMATS_DATABASES_RGL_FILE_H_

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/base/merl_grid.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// The BRDF of a material measured at RGL/EPFL (`*_rgb.bsdf` and `*_spec.bsdf`, Dupuy and Jakob
// 2018).
class RglBrdf {
 public:
  // Throws Error unless the bytes are a complete, consistent tensor file of a material.
  // `bands`: SourceOptions::bands, of a file of spectra.
  static RglBrdf Parse(std::string_view bytes, const std::string& source,
                       const std::string& bands = "");
  RglBrdf(RglBrdf&&) noexcept;
  RglBrdf& operator=(RglBrdf&&) noexcept;
  ~RglBrdf();

  bool isotropic() const;  // one phi_i in the file

  // An anisotropic material as scattered samples at the nodes of the file: for each theta_i and
  // phi_i, the outgoing directions of the nodes of `rgb`. Directions that the file omits by
  // symmetry are included. Nodes that were not measured are omitted unless `extrapolated`.
  Measurement Sample(const std::string& source, bool extrapolated) const;

  // The largest measured theta_i, at most 90 degrees [rad].
  double max_theta() const;

  // BRDF [1/sr], >= 0 (docs/file-formats.md); 0 where a direction is below the surface.
  Rgb Evaluate(const DirectionPair& directions) const { return LookUp(directions).rho; }

  // For a file of isotropic spectra: their wavelengths [nm], ascending, and the BRDF [1/sr] at
  // these, like Evaluate. Both are empty for others.
  const std::vector<double>& wavelengths() const;
  std::vector<double> Spectrum(const DirectionPair& directions) const;

  // Number of wavelengths in the file, 0 for RGB, and a note on those that were read
  // (SpectrumBands::Note).
  int bands() const;
  const std::string& bands_note() const;

  // The same as Evaluate, and whether all nodes of `rgb` with nonzero weight were measured.
  MeasuredValue LookUp(const DirectionPair& directions) const;

 private:
  struct Tables;
  struct Place;
  Place Locate(const DirectionPair& directions) const;
  explicit RglBrdf(std::unique_ptr<const Tables> tables);
  std::unique_ptr<const Tables> tables_;
};

// The BRDF at the centres of all bins above the surface, and which of them were measured
// (docs/your-data.md). Other bins are invalid. Throws Error for an anisotropic material.
BrdfTable TabulateRgl(const RglBrdf& brdf, const std::string& source, const MerlGrid& grid = {},
                      int num_threads = 1);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_DATABASES_RGL_FILE_H_
