#ifndef TRILOBE_IO_FORMATS_MEASUREMENT_FORMAT_H_
#define TRILOBE_IO_FORMATS_MEASUREMENT_FORMAT_H_

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// How a source is read, and what of it counts as measured. Noise matters to `synth:` only,
// `extrapolated` to RGL files, the radiometry to UTIA files; where they are given for others, a
// note of the measurement says so.
struct SourceOptions {
  double noise = 0.0;        // relative standard deviation of the multiplicative noise, 0 to 1
  double missing = 0.0;      // share of the bins or samples that is left out at random, 0 up to 1
  std::string corrupt = {};  // ParseCorruptions: what happens to what was measured, by `seed`
  double cosine = 0;         // exponent of the cos theta_i that is taken out of what was measured
  // By which the sample leant towards azimuth 0, which is taken out; none: as its highlight shows.
  std::optional<double> tilt_deg = 0;
  uint64_t seed = 1;
  int num_threads = 1;
  double max_angle_deg = 90;  // theta_i and theta_o beyond it do not count as measured; above 0
  // theta_d below it does not; -1: as far as a detector stood in its own light, by scattered
  // samples.
  double min_theta_d_deg = -1;
  bool extrapolated = false;        // what the authors of a file made up counts as measured
  bool outliers = false;            // samples that are far off those around them count as well
  bool dark_noise = false;          // readings that are lost in it count as they are
  std::string radiometry = "brdf";  // of UtiaRadiometries()
};

// Throws Error, with the option's flag and value, where one is out of its range, whether it matters
// or not.
void CheckSourceOptions(const SourceOptions& options);

// A format of files that hold a measurement. Each is described in the file of its reader and
// writer, by a function `MeasurementFormat NAMEFormat()`, exactly that, which source.cc declares
// and lists.
struct MeasurementFormat {
  std::string name;         // "merl"
  std::string description;  // "a MERL .binary file"
  std::string ending;       // ".binary": of such files' names
  bool is_text = false;
  // Whether bytes are those of such a file, or of its beginning, as far as that tells. What is JSON
  // or foreign (a picture, an archive) is not asked for.
  bool (*recognise)(std::string_view bytes) = nullptr;
  // Throws Error for bytes that are no such file; `source` is its name.
  Measurement (*read)(std::string_view bytes, const std::string& source,
                      const SourceOptions& options) = nullptr;

  // Of a format that is written, too: what the file then is, "MERL layout", and whether samples at
  // any directions, not only at bins, have a place in it.
  std::string written_as = {};
  bool holds_anisotropic = false;
  // Returns what was written, for a message: "12 samples". Throws Error where the format has no
  // place for the data, and leaves no file then.
  std::string (*write)(const Measurement& measurement, const std::string& path,
                       int num_threads) = nullptr;
};

// For `read`: a parser that has no use for options.
template <Measurement (*kParse)(std::string_view, const std::string&)>
Measurement ReadBy(std::string_view bytes, const std::string& source,
                   const SourceOptions& /*options*/) {
  return kParse(bytes, source);
}

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_MEASUREMENT_FORMAT_H_
