#ifndef TRILOBE_IO_SOURCE_H_
#define TRILOBE_IO_SOURCE_H_

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/brdf/brdf_table.h"
#include "trilobe/io/hemisphere_grid.h"
#include "trilobe/io/measurement.h"
#include "trilobe/io/synth.h"

namespace trilobe {

// A measurement by the name that a user types: a path to a file of one of MeasurementFormats(), or
// `synth:NAME`, or `synth:NAME@18x72`, at the directions of that HemisphereGrid. Noise matters to
// `synth:` only, `extrapolated` to RGL files, the radiometry to UTIA files.
// Throws Error.
struct SourceOptions {
  double noise = 0.0;    // relative standard deviation of the multiplicative noise
  double missing = 0.0;  // share of the bins or samples that is left out at random
  uint64_t seed = 1;
  int num_threads = 1;
  double max_angle_deg = 90;  // theta_i and theta_o beyond it do not count as measured
  // theta_d below it does not; below 0: as far as a detector stood in its own light, by scattered
  // samples.
  double min_theta_d_deg = -1;
  bool extrapolated = false;        // what the authors of a file made up counts as measured
  std::string radiometry = "brdf";  // of UtiaRadiometries()
};
Measurement LoadMeasurement(const std::string& source, const SourceOptions& options = {});

// The same where a table is needed. Throws Error for scattered data, too.
BrdfTable LoadSource(const std::string& source, const SourceOptions& options = {});

// Whether the source is synth:NAME, and if it is, what it names: the material, and the grid of
// directions where there is one, as all anisotropic materials have. Throws Error for an unknown
// NAME.
bool IsSynthetic(std::string_view source);
struct SynthSource {
  const SynthMaterial& material;
  std::optional<HemisphereGrid> grid = {};
};
SynthSource SynthSourceOf(std::string_view source);

// The measurement in the bytes of a file, whose name `source` is. Its content tells the format; the
// ending of the name decides only where the content could be anything. Throws Error.
Measurement ParseMeasurement(std::string_view bytes, const std::string& source,
                             const SourceOptions& options = {});
BrdfTable ParseSource(std::string_view bytes, const std::string& source,
                      const SourceOptions& options = {});

// What these do last: decides, by the options, which bins or samples that were read count as
// measured.
void DecideMeasured(const SourceOptions& options, BrdfTable* table);
void DecideMeasured(const SourceOptions& options, Measurement* measurement);

// A format of files that hold a measurement.
struct MeasurementFormat {
  std::string name;         // "merl"
  std::string description;  // "a MERL .binary file"
  std::string ending;       // ".binary": of such files' names
  bool is_text = false;
  bool (*recognise)(std::string_view bytes) = nullptr;
  Measurement (*read)(std::string_view bytes, const std::string& source,
                      const SourceOptions& options) = nullptr;
};
const std::vector<MeasurementFormat>& MeasurementFormats();

}  // namespace trilobe

#endif  // TRILOBE_IO_SOURCE_H_
