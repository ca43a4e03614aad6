#ifndef TRILOBE_IO_FORMATS_SOURCE_H_
#define TRILOBE_IO_FORMATS_SOURCE_H_

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "trilobe/core/base/merl_grid.h"
#include "trilobe/io/formats/measurement_format.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/measurement/hemisphere_grid.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/measurement/synth.h"

namespace trilobe {

// A source of a measurement, by name: a path to a file of one of MeasurementFormats();
// `synth:NAME`, a synthetic material; `synth:NAME@18x72`, the same at the directions of that
// HemisphereGrid; or `synth:NAME@30x30x60`, a table of that MerlGrid. Use:
//
//   const Measurement measurement = Source("synth:plastic@30x30x60").Read({.noise = 0.02});
class Source {
 public:
  // Reads the file unless the name is synth:NAME. Throws Error if that fails.
  explicit Source(std::string name);
  // A file with these bytes. `name` appears in messages; its extension selects the format if the
  // bytes do not.
  Source(std::string name, std::string bytes);

  const std::string& name() const { return name_; }
  const std::string& bytes() const { return bytes_; }  // of the file; empty if synthetic
  bool synthetic() const;

  // Parses the file or evaluates the formula. Then applies the corruptions, removes invalid
  // readings, and limits the angles, as the options say. Throws Error.
  Measurement Read(const SourceOptions& options = {}) const;

  // Name of a synthetic source, else a hash of the bytes. Equal fingerprints and options give equal
  // measurements.
  std::string Fingerprint() const;

 private:
  Measurement Synthesized(const SourceOptions& options) const;
  Measurement Parsed(const SourceOptions& options) const;

  std::string name_;
  std::string bytes_;
};

// Source(name).Read(options).
Measurement LoadMeasurement(const std::string& name, const SourceOptions& options = {});

// The same for a table. Throws Error also for scattered data.
BrdfTable LoadTable(const std::string& name, const SourceOptions& options = {});

// Whether a name is synth:NAME.
bool IsSynthetic(std::string_view name);
// The material and grid of such a name; an anisotropic material has a HemisphereGrid. Throws Error
// for an unknown NAME and for grids of more than ten million samples.
struct SynthSource {
  const SynthMaterial& material;
  std::variant<MerlGrid, HemisphereGrid> grid;
};
SynthSource SynthSourceOf(std::string_view name);

// A step of Source::Read: notes which of the options that were given cannot change a measurement
// that a reader of this name has read ("utia").
void NoteUnread(const SourceOptions& options, std::string_view reader, Measurement* measurement);

// A step of Source::Read: applies SourceOptions::corrupt, then removes `tilt_deg`, `cosine` and
// `cosine_o`, multiplies by `scale` and turns azimuths.
void CorruptBy(const SourceOptions& options, Measurement* measurement);

// The last step of Source::Read: decides which bins or samples count as measured.
void DecideMeasured(const SourceOptions& options, BrdfTable* table);
void DecideMeasured(const SourceOptions& options, Measurement* measurement);

// All formats, in the order in which RecogniseFormat tries them.
const std::vector<MeasurementFormat>& MeasurementFormats();

// The first format that recognises the bytes, which may be the beginning of a file. Null if none
// does.
const MeasurementFormat* RecogniseFormat(std::string_view bytes);

// Throws Error, for example "FILE: OTHERWISE: this is a MERL .binary file", if the bytes (or the
// beginning of a file) have a known format that is not JSON. `otherwise` may say what the file is
// then, as "not a model file".
void CheckMayBeJson(std::string_view bytes, const std::string& file,
                    const std::string& otherwise = "");

// The format with the extension of `path`; without an extension, the first that can be written.
// Throws Error, which lists the known extensions, for others.
const MeasurementFormat& WritableFormat(const std::string& path);

// Writes a measurement in WritableFormat(path). Returns a description for a message: "CSV, 12
// samples". Throws Error if the format cannot hold the data. `before_renaming`: as of
// MeasurementFormat::write.
std::string WriteMeasurement(
    const Measurement& measurement, const std::string& path, int num_threads = 1,
    const BeforeRenaming& before_renaming = [](std::string_view) {});

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_SOURCE_H_
