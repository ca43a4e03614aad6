#ifndef TRILOBE_FIT_REPORTS_PRINT_H_
#define TRILOBE_FIT_REPORTS_PRINT_H_

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/base/text.h"
#include "trilobe/core/geometry/channels.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// By how much a PSNR falls [dB]: 0 where both are infinite, as those of exact fits are.
double PsnrFall(double before, double after);

// "0.1, 0.2, 0.3".
std::string Text(const Rgb& rgb);

// Right-justified in `width` columns, or after two spaces where it is wider.
std::string AlignRight(const std::string& text, int width);

// A line of standard output, whatever names are in it (Printable).
void PrintLine(const std::string& text);

// "label", spaces up to a fixed column, "value", on such a line.
void PrintLine(const std::string& label, const std::string& value);

// What a measurement's reader found wrong with it, a line each on standard error.
void PrintNotes(const Measurement& measurement);

// One object and a newline on standard output. A number that is not finite becomes null, text that
// is not UTF-8 is repaired.
void PrintJson(const nlohmann::ordered_json& json);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_PRINT_H_
