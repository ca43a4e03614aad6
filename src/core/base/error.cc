#include "trilobe/core/base/error.h"

#include <cmath>
#include <sstream>

namespace trilobe {

std::string_view NameOf(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kFormat:
      return "format";
    case ErrorKind::kRange:
      return "range";
    case ErrorKind::kUnknown:
      return "unknown";
    case ErrorKind::kConflict:
      return "conflict";
    case ErrorKind::kMismatch:
      return "mismatch";
    case ErrorKind::kMissing:
      return "missing";
    case ErrorKind::kUnsupported:
      return "unsupported";
    case ErrorKind::kFile:
      return "file";
    case ErrorKind::kData:
      return "data";
    case ErrorKind::kLimit:
      return "limit";
  }
  return "";
}

std::string FactText(double number) {
  if (std::isnan(number)) return "nan";  // never "-nan"
  constexpr int kDigits = 10;            // of any index
  std::ostringstream text;
  text.precision(kDigits);
  text << number;
  return text.str();
}

}  // namespace trilobe
