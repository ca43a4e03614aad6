#ifndef TRILOBE_IO_FORMATS_DATABASES_UTIA_FILE_H_
#define TRILOBE_IO_FORMATS_DATABASES_UTIA_FILE_H_

#include <string>
#include <string_view>
#include <vector>

#include "core/files/file.h"
#include "trilobe/model/measurement/hemisphere_grid.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// UTIA BRDF database `.bin` (Filip and Vavra 2014, docs/file-formats.md): planes R, G, B of
// 288 x 288 little-endian float64, without a header: row 48 a + b is the incident, column 48 a + b
// the outgoing direction with theta = 15 a and phi = 7.5 b degrees.
inline constexpr HemisphereGrid kUtiaGrid = {.thetas = 6, .phis = 48};

// Conversion of stored numbers to a BRDF, on which public readers disagree.
struct UtiaRadiometry {
  std::string name;         // "brdf"
  std::string description;  // what the numbers are taken for, and by whom
  double (*to_brdf)(double stored, double cos_theta_i) = nullptr;  // [1/sr]
};
const std::vector<UtiaRadiometry>& UtiaRadiometries();  // the default first

// Parses scattered samples, with phi as in the file also at theta = 0. Adds a note if the numbers
// seem to be in another order. Throws Error for other sizes and unknown radiometries. Can read the
// format on another grid.
Measurement ParseUtia(std::string_view bytes, const std::string& source,
                      std::string_view radiometry = UtiaRadiometries().front().name,
                      const HemisphereGrid& grid = kUtiaGrid);

// Writes samples at these directions as BRDF [1/sr], and -1 for missing ones. Throws Error if a
// sample is at another direction or two are at the same.
// `before_renaming`: as of WriteFile.
void WriteUtia(
    const Measurement& scattered, const std::string& path,
    const BeforeRenaming& before_renaming = [](std::string_view) {});

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_DATABASES_UTIA_FILE_H_
