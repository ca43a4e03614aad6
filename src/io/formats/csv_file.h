#ifndef TRILOBE_IO_FORMATS_CSV_FILE_H_
#define TRILOBE_IO_FORMATS_CSV_FILE_H_

#include <string>
#include <string_view>

#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// Samples as comma-separated values (docs/file-formats.md): a header row that names the columns
// theta_i, phi_i, theta_o, phi_o [degrees], r, g, b [1/sr] in any order, then a row a sample; from
// a # on a line is a comment. Throws Error, with line and column, on anything else.
Measurement ParseCsv(std::string_view text, const std::string& source);

// Writes the valid samples, as many digits as read back to the same numbers, row by row. Those of a
// table stand at the centres of its bins, with phi_i = 0. Returns how many. Throws Error where
// there is none.
int WriteCsv(const Measurement& measurement, const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_CSV_FILE_H_
