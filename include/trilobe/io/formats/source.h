#ifndef TRILOBE_IO_FORMATS_SOURCE_H_
#define TRILOBE_IO_FORMATS_SOURCE_H_

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "trilobe/core/geometry/merl_grid.h"
#include "trilobe/io/formats/measurement_format.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/measurement/hemisphere_grid.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/synth/synth.h"

namespace trilobe {

// A measurement by the name that a user types: a path to a file of one of MeasurementFormats(), or
// `synth:NAME`, or `synth:NAME@18x72`, at the directions of that HemisphereGrid, or
// `synth:NAME@30x30x60`, a table of that MerlGrid. Throws Error.
Measurement LoadMeasurement(const std::string& source, const SourceOptions& options = {});

// The same where a table is needed. Throws Error for scattered data, too.
BrdfTable LoadSource(const std::string& source, const SourceOptions& options = {});

// Whether the source is synth:NAME, and if it is, what it names: the material, and the grid of
// directions or of bins; anisotropic materials have the former. Throws Error for an unknown NAME,
// and for grids of more than ten million samples.
bool IsSynthetic(std::string_view source);
struct SynthSource {
  const SynthMaterial& material;
  std::variant<MerlGrid, HemisphereGrid> grid;
};
SynthSource SynthSourceOf(std::string_view source);

// The measurement in the bytes of a file, whose name `source` is. Its content tells the format; the
// ending of the name decides only where the content could be anything. Throws Error.
Measurement ParseMeasurement(std::string_view bytes, const std::string& source,
                             const SourceOptions& options = {});
BrdfTable ParseSource(std::string_view bytes, const std::string& source,
                      const SourceOptions& options = {});

// What these do before: corrupts what was read, and takes a tilt and a cosine out of it, by the
// options.
void CorruptBy(const SourceOptions& options, Measurement* measurement);

// What these do last: decides, by the options, which bins or samples that were read count as
// measured.
void DecideMeasured(const SourceOptions& options, BrdfTable* table);
void DecideMeasured(const SourceOptions& options, Measurement* measurement);

// Those of the library; the first that recognises a file reads it.
const std::vector<MeasurementFormat>& MeasurementFormats();

// The one in which a file of this name is written, by its ending; without one, the first. Throws
// Error, which names the endings that there are, for others.
const MeasurementFormat& WritableFormat(const std::string& path);

// Writes a measurement so. Returns what was written, for a message: "CSV, 12 samples". Throws Error
// where the format has no place for the data.
std::string WriteMeasurement(const Measurement& measurement, const std::string& path,
                             int num_threads = 1);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_SOURCE_H_
