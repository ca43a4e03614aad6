#ifndef TRILOBE_APP_FLAGS_H_
#define TRILOBE_APP_FLAGS_H_

#include <gflags/gflags_declare.h>

#include <map>
#include <string>
#include <vector>

#include "trilobe/model/appearance/appearance.h"

// Flags that several commands take.
DECLARE_int32(threads);
DECLARE_int32(lobes);
DECLARE_int64(seed);
DECLARE_double(noise);
DECLARE_double(missing);
DECLARE_string(corrupt);
DECLARE_double(cosine);
DECLARE_string(tilt);
DECLARE_double(max_angle);
DECLARE_double(min_theta_d);
DECLARE_string(radiometry);
DECLARE_bool(extrapolated);
DECLARE_bool(outliers);
DECLARE_bool(dark_noise);
DECLARE_string(weighting);
DECLARE_string(out);

// What lights the spheres of fit, score and plot.
DECLARE_string(probe);

// What `score` and `info` print: a table for people, or one JSON object.
DECLARE_bool(json);
// What `fit` and `score` print: a verdict and a few lines, or all there is to say.
DECLARE_bool(verbose);

namespace trilobe {

struct SourceOptions;

// True unless the flag was given a value other than its default.
bool IsDefault(const std::string& flag);

// The flags of these that were given, by name, as text.
std::map<std::string, std::string> GivenFlags(const std::vector<std::string>& flags);

// A flag for `trilobe help COMMAND`: "  --lobes=3", and its description on the next line.
std::string FlagHelp(const std::string& flag);

// --threads, with 0 meaning all cores, and no more than these: beyond, the first call says so on
// standard error. Throws Error if negative.
int ThreadsFromFlags();

// What says how a source is read: for Source::Read. Throws Error for bad values. And the names of
// these flags.
SourceOptions SourceOptionsFromFlags();
std::vector<std::string> WithSourceFlags(std::vector<std::string> others);
// Those of them that are for measurements alone: all but --threads.
std::vector<std::string> MeasurementFlags();

// Throws Error where one of these flags is given, since `path` is a model and no measurement.
void RefuseForModel(const std::string& path, const std::vector<std::string>& flags);

// The light of --probe, or the built-in one, and --threads. Reads the probe at the first call.
AppearanceOptions AppearanceOptionsFromFlags();

}  // namespace trilobe

#endif  // TRILOBE_APP_FLAGS_H_
