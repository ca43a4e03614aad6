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

// Where a measurement comes from, by the name that a user types: a path to a file of one of
// MeasurementFormats(), or `synth:NAME`, or `synth:NAME@18x72`, at the directions of that
// HemisphereGrid, or `synth:NAME@30x30x60`, a table of that MerlGrid.
class Source {
 public:
  // Reads the file of that name, if it is one. Throws Error where that fails.
  explicit Source(std::string name);
  // A file whose bytes are at hand. Messages have its name, whose ending tells the format where the
  // bytes could be of several.
  Source(std::string name, std::string bytes);

  const std::string& name() const { return name_; }
  const std::string& bytes() const { return bytes_; }  // of the file; none if synthetic
  bool synthetic() const;

  // The measurement, read from the file or made by formula, and then, in the same way for both,
  // corrupted, rid of what is no measurement, and limited, as the options say. Throws Error.
  Measurement Read(const SourceOptions& options = {}) const;

  // Sources of one fingerprint give the same measurement by the same options. It is a synthetic
  // source's name, or a hash of the bytes.
  std::string Fingerprint() const;

 private:
  Measurement Synthesized(const SourceOptions& options) const;
  Measurement Parsed(const SourceOptions& options) const;

  std::string name_;
  std::string bytes_;
};

// Source(name).Read(options).
Measurement LoadMeasurement(const std::string& name, const SourceOptions& options = {});

// The same where a table is needed. Throws Error for scattered data, too.
BrdfTable LoadTable(const std::string& name, const SourceOptions& options = {});

// Whether a name is synth:NAME, and if it is, what it says: the material, and the grid of
// directions or of bins; anisotropic materials have the former. Throws Error for an unknown NAME,
// and for grids of more than ten million samples.
bool IsSynthetic(std::string_view name);
struct SynthSource {
  const SynthMaterial& material;
  std::variant<MerlGrid, HemisphereGrid> grid;
};
SynthSource SynthSourceOf(std::string_view name);

// A step of Source::Read: corrupts what was read, and takes a tilt and a cosine out of it, by the
// options.
void CorruptBy(const SourceOptions& options, Measurement* measurement);

// Its last step: decides, by the options, which bins or samples that were read count as measured.
void DecideMeasured(const SourceOptions& options, BrdfTable* table);
void DecideMeasured(const SourceOptions& options, Measurement* measurement);

// Those of the library, in the order in which they are asked.
const std::vector<MeasurementFormat>& MeasurementFormats();

// The first that recognises the bytes of a file, or its beginning; null where none does.
const MeasurementFormat* RecogniseFormat(std::string_view bytes);

// Throws Error "WHAT: this is a MERL .binary file" for the bytes of a file, or its beginning, that
// are known, and are no JSON text.
void CheckMayBeJson(std::string_view bytes, const std::string& what);

// The one in which a file of this name is written, by its ending; without one, the first. Throws
// Error, which names the endings that there are, for others.
const MeasurementFormat& WritableFormat(const std::string& path);

// Writes a measurement so. Returns what was written, for a message: "CSV, 12 samples". Throws Error
// where the format has no place for the data.
std::string WriteMeasurement(const Measurement& measurement, const std::string& path,
                             int num_threads = 1);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_SOURCE_H_
