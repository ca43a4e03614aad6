#ifndef TRILOBE_IO_FORMATS_TEXT_TABLE_READER_H_
#define TRILOBE_IO_FORMATS_TEXT_TABLE_READER_H_

#include <string>
#include <string_view>

#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {

// Samples in a text table (docs/file-formats.md): a header that names columns of angles [degrees,
// unless it says radians] and of values [1/sr], R, G, B, one for all channels or a spectrum, then a
// row a sample; or rows alone, with SourceOptions::columns. What is not as this library writes it,
// theta_i,phi_i,theta_o,phi_o,r,g,b between commas, is told in a note. Throws Error, with the line,
// for what is no such table, and for what its names leave open.
//
// In the plane of incidence angles have signs: without azimuths, theta_o > 0 is on the side of the
// mirror direction (ASTM E2387), unless samples of both signs are brighter on the other.
Measurement ReadTextTable(std::string_view text, const std::string& source,
                          const SourceOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_TABLE_READER_H_
