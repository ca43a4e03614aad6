#ifndef TRILOBE_IO_FORMATS_MBSDF_FILE_H_
#define TRILOBE_IO_FORMATS_MBSDF_FILE_H_

#include <string>
#include <string_view>

#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// A measured BSDF of NVIDIA's Material Definition Language (`.mbsdf`, MDL specification, appendix
// E; docs/file-formats.md), its part for reflection: float32 BRDF values [1/sr], RGB or one for all
// channels, on a grid of theta_in, theta_out and the angle between the azimuths, 0 to 180 degrees.
// Samples stand at the centres of the cells. Throws Error on anything else.
Measurement ParseMbsdf(std::string_view bytes, const std::string& source);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_MBSDF_FILE_H_
