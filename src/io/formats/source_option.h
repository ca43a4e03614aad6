#ifndef TRILOBE_IO_FORMATS_SOURCE_OPTION_H_
#define TRILOBE_IO_FORMATS_SOURCE_OPTION_H_

#include <string>
#include <string_view>
#include <vector>

#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {

// An option of a measurement, under the name that it has as a flag and in scene files.
struct SourceOption {
  std::string name;  // "max_angle"
  // Sets it by the text of a flag: "65", "true", "o:1". Throws Error, with flag and text, for one
  // that means nothing. CheckSourceOptions checks ranges.
  void (*set)(std::string_view text, SourceOptions* options) = nullptr;
  // A text that differs for different values.
  std::string (*get)(const SourceOptions& options) = nullptr;
};

// All but num_threads, which changes no measurement.
const std::vector<SourceOption>& AllSourceOptions();

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_SOURCE_OPTION_H_
