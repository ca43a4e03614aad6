#ifndef TRILOBE_IO_FORMATS_MEASUREMENT_FORMAT_H_
#define TRILOBE_IO_FORMATS_MEASUREMENT_FORMAT_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// How a source is read and which of its samples count as measured. `noise` is for `synth:` only,
// `extrapolated` for RGL files, `radiometry` for UTIA files, `columns`, `rows`, `theta_i_deg`
// and `theta_o_deg` for text tables, `bands` for spectra, `azimuth_from_mirror` for scattered
// samples; for other sources they only add a note to the measurement.
struct SourceOptions {
  double noise = 0.0;        // relative standard deviation of multiplicative noise, 0 to 1
  double missing = 0.0;      // fraction of bins or samples removed at random, in [0, 1)
  std::string corrupt = {};  // corruptions to apply (ParseCorruptions), seeded by `seed`
  double cosine = 0;         // exponent of a factor cos theta_i to remove, -2 to 2
  double cosine_o = 0;       // the same of cos theta_o
  // Factor of all values; 0 stands for 1 that nobody gave: given, it says what values called
  // reflectance are.
  double scale = 0;
  // Azimuths phi_o of scattered samples are counted from the mirror direction, phi_i + 180 degrees.
  bool azimuth_from_mirror = false;
  // Tilt of the sample towards azimuth 0, to remove; nullopt: estimated from the highlight.
  std::optional<double> tilt_deg = 0;
  uint64_t seed = 1;
  bool seed_is_for_data = false;  // whoever gave it means random changes: a note if there are none
  int num_threads = 1;
  double max_angle_deg = 90;  // larger theta_i and theta_o do not count as measured; above 0
  // Smaller theta_d do not count as measured; -1: the limit at which scattered samples show the
  // detector's own shadow.
  double min_theta_d_deg = -1;
  bool extrapolated = false;        // values that the authors extrapolated count as measured
  bool outliers = false;            // keeps samples far from their neighbours
  bool dark_noise = false;          // keeps readings of a table that are lost in dark noise
  std::string radiometry = "brdf";  // of UtiaRadiometries()
  // Names of the columns of a text table, "theta_i,theta_o,f", in the place of those of its header,
  // or some with these, "theta_i=Angle,f=Value".
  std::string columns = {};
  // The rows of a text table with these cells, "polarization=s,sample=2"; "": all.
  std::string rows = {};
  double theta_i_deg = -1;  // of a text table without a column theta_i, 0 to below 90; -1: none
  double theta_o_deg = -1;  // the same of theta_o
  // Wavelengths [nm] of spectra, "650,550,450": one for all channels, three as r, g and b, the
  // longest as r, or more to make a colour of; "": all.
  std::string bands = {};
  // A text table may have directions alone; its values are 0, and all count.
  bool may_lack_values = false;
  // Readings are copied: as if `outliers` and `dark_noise` were set, which change nothing then.
  bool as_they_are = false;
};

// Throws Error, with the option's flag and value, if one is out of range.
void CheckSourceOptions(const SourceOptions& options);

using BeforeRenaming = std::function<void(std::string_view content)>;

// A file format of measurements. A function `MeasurementFormat NAMEFormat()` in the file of its
// reader and writer defines it; source.cc declares and lists these functions by NAME.
struct MeasurementFormat {
  std::string name;         // "merl"
  std::string description;  // "a MERL .binary file"
  std::string ending;       // file extension, ".binary"
  bool is_text = false;
  bool is_json = false;  // an object of JSON
  // Whether the bytes look like such a file or its beginning. Called for JSON only if the format is
  // that, and not for foreign content (a picture, an archive).
  bool (*recognise)(std::string_view bytes) = nullptr;
  // Parses a file named `source`. Throws Error for invalid bytes.
  Measurement (*read)(std::string_view bytes, const std::string& source,
                      const SourceOptions& options) = nullptr;

  // For formats with `write`: what the file is called in messages, "MERL layout", and whether it
  // holds samples at any directions, not only at bins.
  std::string written_as = {};
  bool holds_anisotropic = false;
  // Returns what was written, for a message: "12 samples". Throws Error, and leaves no file, if the
  // format cannot hold the data. `before_renaming` is called with the content when it is complete
  // and before it replaces what is at `path`, which stays if this throws.
  std::string (*write)(const Measurement& measurement, const std::string& path, int num_threads,
                       const BeforeRenaming& before_renaming) = nullptr;
};

// Adapts a parser without options to `read`.
template <Measurement (*kParse)(std::string_view, const std::string&)>
Measurement ReadBy(std::string_view bytes, const std::string& source,
                   const SourceOptions& /*options*/) {
  return kParse(bytes, source);
}

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_MEASUREMENT_FORMAT_H_
