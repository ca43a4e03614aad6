#ifndef TRILOBE_FIT_REPORTS_PRINT_H_
#define TRILOBE_FIT_REPORTS_PRINT_H_

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/base/text.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// Decrease of a PSNR [dB]; 0 if both are infinite (exact fits).
double PsnrFall(double before, double after);

// Formats as "0.1, 0.2, 0.3".
std::string Text(const Rgb& rgb);

// Right-justifies in `width` columns; a wider text follows two spaces.
std::string AlignRight(const std::string& text, int width);

// Prints a line on standard output; unprintable characters are replaced (Printable).
void PrintLine(const std::string& text);

// Prints label and value on such a line, with the value at a fixed column.
void PrintLine(const std::string& label, const std::string& value);

// Prints the notes of a measurement, one per line, on standard error.
void PrintNotes(const Measurement& measurement);

// Prints an object and a newline on standard output. Numbers that are not finite become null;
// invalid UTF-8 is repaired.
void PrintJson(const nlohmann::ordered_json& json);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_PRINT_H_
