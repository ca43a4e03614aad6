#ifndef TRILOBE_IO_FORMATS_ZEMAX_FILE_H_
#define TRILOBE_IO_FORMATS_ZEMAX_FILE_H_

#include <string>
#include <string_view>

#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// A BRDF in the tabular text format of Zemax OpticStudio (`.bsdf`, docs/file-formats.md), by sample
// rotation, angle of incidence, and azimuth and distance about the direction of mirror reflection
// [degrees]; one channel, which counts for all three. A value of exactly 0 is a gap. Azimuths
// matter where there are several sample rotations. Throws Error, with the line, on anything else.
Measurement ParseZemax(std::string_view text, const std::string& source);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_ZEMAX_FILE_H_
