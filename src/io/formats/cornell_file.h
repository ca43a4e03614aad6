#ifndef TRILOBE_IO_FORMATS_CORNELL_FILE_H_
#define TRILOBE_IO_FORMATS_CORNELL_FILE_H_

#include <string>
#include <string_view>

#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// Spectra measured by the gonioreflectometer of Cornell's Program of Computer Graphics, as pbrt-v2
// has them (`.brdf`, docs/file-formats.md): the number of wavelengths, these [nm], then a line a
// sample with theta_i, phi_i, theta_o, phi_o [rad] and the BRDF [1/sr] at each wavelength. They
// become colours as SpectralColor says. Throws Error, with line and column, on anything else.
Measurement ParseCornell(std::string_view text, const std::string& source);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_CORNELL_FILE_H_
