#ifndef TRILOBE_APP_FLAGS_H_
#define TRILOBE_APP_FLAGS_H_

#include <gflags/gflags_declare.h>

#include <map>
#include <string>
#include <vector>

#include "trilobe/core/base/option_value.h"
#include "trilobe/model/appearance/appearance.h"

// Flags shared by several commands.
DECLARE_int32(threads);
DECLARE_int64(seed);
DECLARE_string(out);
DECLARE_bool(force);

// Light of the spheres of fit, score and plot.
DECLARE_string(probe);

// Whether `score` and `info` print a JSON object instead of a table.
DECLARE_bool(json);
// Whether `fit` and `score` print all details, not only the verdict and a few lines.
DECLARE_bool(verbose);

namespace trilobe {

struct SourceOptions;

// Defines a flag by a row of a table of options, once. Call it before the command line is read.
void DefineFlag(const std::string& name, const std::string& help, const OptionValue& default_value);
// The value of a flag that DefineFlag has defined. Throws std::out_of_range for another.
const OptionValue& FlagValue(const std::string& name);
// The same for a flag whose values are texts, and for one that is true or false.
const std::string& TextFlag(const std::string& name);
bool IsOn(const std::string& name);
// Defines the flags of AllSourceOptions().
void DefineSourceFlags();

// Whether the flag was not given.
bool IsDefault(const std::string& flag);
// The value of a flag of any type, as one would write it.
std::string FlagText(const std::string& flag);

// The parts of the value of a flag, without blanks around them.
std::vector<std::string> Split(const std::string& text, char separator);

// Values of those of these flags that were given, by name.
std::map<std::string, std::string> GivenFlags(const std::vector<std::string>& flags);

// --threads, at most the number of cores; 0: all cores. The first call with more prints a warning
// on standard error. Throws Error if negative.
int ThreadsFromFlags();

// Options for Source::Read. `has_starts`: --seed is of random starts, too, and need not be of the
// data. Throws Error for bad values.
SourceOptions SourceOptionsFromFlags(bool has_starts = false);
// `others` and the names of the flags that SourceOptionsFromFlags reads.
std::vector<std::string> WithSourceFlags(std::vector<std::string> others);
// The names of these flags without --threads.
std::vector<std::string> MeasurementFlags();

// Throws Error if one of these flags was given, for a `path` that is a model.
void RefuseForModel(const std::string& path, const std::vector<std::string>& flags);

// Options by --probe (default: the built-in light) and --threads. Reads the probe once.
AppearanceOptions AppearanceOptionsFromFlags();

}  // namespace trilobe

#endif  // TRILOBE_APP_FLAGS_H_
