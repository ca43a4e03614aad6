#ifndef TRILOBE_TESTS_IO_FORMATS_READ_AS_H_
#define TRILOBE_TESTS_IO_FORMATS_READ_AS_H_

#include <string>
#include <string_view>

#include "core/base/names.h"
#include "trilobe/io/formats/source.h"

namespace trilobe {

// Reads the bytes by the format of that name, such as "csv", whichever format recognises them.
inline Measurement ReadAs(std::string_view format, std::string_view bytes,
                          const std::string& source) {
  return FindNamed("format", format, MeasurementFormats()).read(bytes, source, {});
}

}  // namespace trilobe

#endif  // TRILOBE_TESTS_IO_FORMATS_READ_AS_H_
