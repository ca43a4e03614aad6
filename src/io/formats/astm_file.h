#ifndef TRILOBE_IO_FORMATS_ASTM_FILE_H_
#define TRILOBE_IO_FORMATS_ASTM_FILE_H_

#include <string>
#include <string_view>

#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// Angle-resolved scatter in the text format of ASTM E1392-96, as Cornell published measurements in
// it and as libbsdf reads it (`.astm`, docs/file-formats.md): a header line a key, of which
// NUM_POINTS and VARS are read; VARS is the last and names the columns of the lines that follow,
// theta_i, phi_i, theta_s, phi_s [rad], and values [1/sr]: R, G, B, or a spectrum (`400nm`, ...,
// which becomes a colour as SpectralColor says), or one value, which is taken for all channels.
// Throws Error, with line and column, on anything else.
Measurement ParseAstm(std::string_view text, const std::string& source);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_ASTM_FILE_H_
