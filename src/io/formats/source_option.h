#ifndef TRILOBE_IO_FORMATS_SOURCE_OPTION_H_
#define TRILOBE_IO_FORMATS_SOURCE_OPTION_H_

#include <string>
#include <string_view>
#include <vector>

#include "trilobe/core/base/option_value.h"
#include "trilobe/io/formats/measurement_format.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// An option of a measurement. The flags of the program, the "options" of scene files, the keywords
// of Python's `read`, the keys of caches, checks and notes are made from these rows.
struct SourceOption {
  std::string name = {};           // "max_angle"
  std::string help = {};           // of the flag
  OptionValue default_value = {};  // of the flag: true or false, a number or a text
  OptionRange range = {};          // of a number

  // For an option of some measurements alone: what it is of, "--radiometry is of UTIA files", and
  // whether it can change this measurement, which a reader of this name has read ("utia").
  std::string of = {};
  bool (*applies)(std::string_view reader, const Measurement& measurement) = nullptr;
  // Whether the other options leave it anything to change; null: they do.
  bool (*is_used)(const SourceOptions& options) = nullptr;
  // Whether it changes directions and values, so that a model that is written as a measurement
  // may have it, too; else it is for readers of files.
  bool changes_values = false;

  // Sets it by the text of a flag: "65", "true", "o:1". Throws Error, with flag and text, for one
  // that means nothing. CheckSourceOptions checks ranges.
  void (*set)(std::string_view text, SourceOptions* options) = nullptr;
  // A text that differs for different values.
  std::string (*get)(const SourceOptions& options) = nullptr;
};

// All but num_threads, which changes no measurement.
const std::vector<SourceOption>& AllSourceOptions();

// Throws Error for an unknown name.
const SourceOption& FindSourceOption(std::string_view name);

// The options that differ from their defaults.
std::vector<const SourceOption*> GivenOptions(const SourceOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_SOURCE_OPTION_H_
