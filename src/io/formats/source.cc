#include "trilobe/io/formats/source.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>
#include <utility>

#include "core/base/names.h"
#include "core/files/content.h"
#include "core/files/file.h"
#include "core/files/text_lines.h"
#include "core/files/utf16.h"
#include "core/system/content_hash.h"
#include "io/formats/databases/utia_file.h"
#include "io/formats/foreign_file.h"
#include "io/formats/source_option.h"
#include "io/formats/text/table_columns.h"
#include "io/formats/text/text_table.h"
#include "model/measurement/note_symptoms.h"
#include "model/measurement/symptoms.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/measurement/corruption.h"
#include "trilobe/model/measurement/synth.h"

// The formats of the library, in the order in which they are asked whether a file is theirs: those
// that a first line or more tells before that of which the size alone does. NAME stands for the
// function NAMEFormat(), which the reader's own file defines: to add a format is one file, and one
// line here.
#define TRILOBE_FOR_EACH_FORMAT(X) \
  X(Merl)                          \
  X(Rgl)                           \
  X(Mbsdf)                         \
  X(Radiance)                      \
  X(Fred)                          \
  X(Alta)                          \
  X(Speos)                         \
  X(Pab)                           \
  X(OpenMaterial)                  \
  X(Ssdd)                          \
  X(JsonTable)                     \
  X(Csv)                           \
  X(LightTools)                    \
  X(Zemax)                         \
  X(Astm)                          \
  X(Cornell)                       \
  X(Utia)

namespace trilobe {

#define TRILOBE_DECLARE(NAME) MeasurementFormat NAME##Format();
TRILOBE_FOR_EACH_FORMAT(TRILOBE_DECLARE)
#undef TRILOBE_DECLARE

namespace {

constexpr std::string_view kSynth = "synth:";

// "30x30x60".
MerlGrid ParseMerlGrid(std::string_view text) {
  std::vector<int> numbers = IntegersByX(text);
  if (numbers.size() != 3) numbers.assign(3, 0);
  const MerlGrid grid = {numbers[0], numbers[1], numbers[2]};
  constexpr int kFewest = 4, kMost = 360;
  const auto [fewest, most] = std::minmax({grid.theta_h, grid.theta_d, grid.phi_d});
  if (fewest < kFewest || most > kMost || 1.0 * grid.theta_h * grid.theta_d * grid.phi_d > 1e7) {
    throw Error(ErrorKind::kFormat,
                "'" + std::string(text) +
                    "' is no grid of bins; give the numbers of theta_h, theta_d and phi_d, as "
                    "30x30x60, each from " +
                    std::to_string(kFewest) + " to " + std::to_string(kMost) +
                    ", and no more than ten million in all")
        .About("grid of bins", text);
  }
  return grid;
}

// "a MERL .binary file, ... or synth:NAME".
std::string WhatMeasurementsAre() {
  std::string text;
  for (const MeasurementFormat& format : MeasurementFormats()) text += format.description + ", ";
  return text + "or synth:NAME";
}

// A text table that lacks a header, or what gives theta_i: its reader says how to give it.
bool IsTable(std::string_view text) {
  constexpr size_t kLookedAt = 1 << 16;
  if (IsTableOfNumbers(text)) return true;
  const auto head = FindTableHead(text.substr(0, kLookedAt), "", /*theta_is_given=*/true);
  if (!head) return LooksLikeTwoColumns(text.substr(0, kLookedAt));
  return std::ranges::any_of(head->names, [](const std::string& name) {
    const ColumnRole role = ColumnNamed(name).role;
    return role >= ColumnRole::kRed && role <= ColumnRole::kBand;
  });
}

// Advice on a file that may hold a measurement in a way that is not read.
std::string WhatIsMissing(Content::Kind kind, std::string_view bytes) {
  const std::string columns =
      std::string("; save its samples as CSV, with the header ") + kUsualColumns;
  if (kind == Content::Kind::kText) {
    return ", with no line of names of columns, or of numbers" + columns;
  }
  const bool is_model = bytes.find("\"format\"") != std::string_view::npos;
  if (kind == Content::Kind::kJson && !is_model) {
    return ", with no columns theta_i, theta_o and brdf" + columns;
  }
  return "";
}

// `is_table`: options say that a text is one.
const MeasurementFormat& FormatOf(std::string_view bytes, const std::string& source,
                                  bool is_table) {
  if (const MeasurementFormat* const format = RecogniseFormat(bytes)) return *format;
  if (const std::string known = ForeignFile(bytes, source); !known.empty()) {
    throw ErrorIn(ErrorKind::kUnsupported, source, "this is " + known)
        .About("content", known.substr(0, known.find_first_of(",;")));
  }
  const std::vector<MeasurementFormat>& formats = MeasurementFormats();
  const Content content = RecogniseContent(bytes);
  const bool is_text = content.kind == Content::Kind::kText;
  if (is_text) CheckLines(bytes, source);
  if (is_text && (is_table || IsTable(bytes))) return FindNamed("format", "csv", formats);
  if (is_text || content.kind == Content::Kind::kUnknown) {
    const std::string ending = EndingOf(source);
    auto found = std::ranges::find_if(formats, [&](const MeasurementFormat& format) {
      return (bytes.empty() || format.is_text == is_text) && format.ending == ending;
    });
    // For binary content with the ending of a text format, the reader of that says what is wrong.
    if (found == formats.end() && !is_text) {
      found = std::ranges::find(formats, ending, &MeasurementFormat::ending);
    }
    if (found != formats.end()) return *found;
  }
  if (content.kind != Content::Kind::kUnknown) {
    throw ErrorIn(ErrorKind::kUnsupported, source,
                  "this is " + content.name + WhatIsMissing(content.kind, bytes) +
                      "; a measurement is " + WhatMeasurementsAre())
        .About("content", content.name);
  }
  if (bytes.empty()) {
    throw ErrorIn(ErrorKind::kFormat, source, "the file is empty").About("content", "empty");
  }
  return formats.front();  // MERL: it says what is wrong with its header
}

// Applies `change`, which notes what it does, unless an option keeps the readings. An option that
// keeps them from nothing is noted instead.
void ChangeUnless(bool kept, const std::string& what, Measurement* measurement,
                  const std::function<void(Measurement*)>& change) {
  if (!kept) {
    change(measurement);
    return;
  }
  Measurement changed = *measurement;
  change(&changed);
  if (changed.notes.size() > measurement->notes.size()) return;
  measurement->notes.push_back(what + ", and changes nothing here");
}

// Leaves out, or mends, readings that the options do not keep. `is_rgl`: the options have told its
// reader what to extrapolate.
void DropBadReadings(const SourceOptions& options, bool is_rgl, Measurement* measurement) {
  const int threads = options.num_threads;
  if (is_rgl || measurement->table) {
    if (!options.extrapolated) LeaveOutFill(measurement);
  } else {
    ChangeUnless(options.extrapolated, "--extrapolated takes samples that seem to be filled in",
                 measurement, LeaveOutFill);
  }
  if (options.as_they_are) {
    if (options.outliers || options.dark_noise) {
      measurement->notes.emplace_back(
          "all readings are copied as they are: --outliers and --dark_noise change nothing here");
    }
    return;
  }
  if (!options.outliers) {
    LeaveOutMarks(measurement);
    LeaveOutZeroGaps(measurement);
  }
  ChangeUnless(options.dark_noise, "--dark_noise takes readings of a table that are lost in it",
               measurement, [&](Measurement* of) { SmoothDarkReadings(threads, of); });
  ChangeUnless(options.outliers, "--outliers takes readings that are far off those around them",
               measurement, [&](Measurement* of) {
                 if (options.outliers) {
                   LeaveOutMarks(of);
                   LeaveOutZeroGaps(of);
                 }
                 LeaveOutOutliers(threads, of);
               });
}

// The tilt that the highlight shows, 0 if it shows none, with a note that says so.
double ShownTilt(Measurement* measurement) {
  const std::string& source = measurement->source;
  if (!measurement->table) {
    throw ErrorIn(ErrorKind::kUnsupported, source,
                  "--tilt=auto goes by the highlight of a table, and this is a " +
                      measurement->kind + "; give degrees")
        .About("tilt", "auto");
  }
  const TiltSymptom tilt = TiltOf(*measurement->table);
  if (!tilt.highlight) {
    throw ErrorIn(ErrorKind::kData, source,
                  "--tilt=auto goes by the highlight, and there is none that is three times as "
                  "bright as what is around it; give degrees")
        .About("tilt", "auto");
  }
  std::ostringstream note;
  note.precision(2);
  note << "the highlight is " << std::abs(tilt.degrees) << " deg off the mirror direction"
       << (tilt.IsThere() ? ", which --tilt=auto takes out"
                          : ", too little or too unsteadily for a tilt: --tilt=auto changes "
                            "nothing");
  measurement->notes.push_back(note.str());
  return tilt.IsThere() ? tilt.degrees : 0;
}

}  // namespace

void NoteUnread(const SourceOptions& options, std::string_view reader, Measurement* measurement) {
  for (const SourceOption* const given : GivenOptions(options)) {
    const bool applies = given->applies == nullptr || given->applies(reader, *measurement);
    const bool is_used = given->is_used == nullptr || given->is_used(options);
    if (applies && is_used) continue;
    measurement->notes.push_back(given->of + ", and changes nothing here");
  }
}

void CorruptBy(const SourceOptions& options, Measurement* measurement) {
  Corrupt(ParseCorruptions(options.corrupt), options.seed, options.num_threads, measurement);
  // Corrections are corruptions, too, the other way round.
  std::vector<Corruption> corruptions;
  const auto apply = [&](const char* name, double strength) {
    const CorruptionKind& kind = FindNamed("kind", name, CorruptionKinds());
    if (strength != kind.nothing) corruptions.push_back({.kind = &kind, .strength = strength});
  };
  apply("tilt", -(options.tilt_deg ? *options.tilt_deg : ShownTilt(measurement)));
  apply("cosine", -options.cosine);
  apply("cosine_o", -options.cosine_o);
  apply("scale", options.scale == 0 ? 1 : options.scale);
  Corrupt(corruptions, options.seed, options.num_threads, measurement);
  if (options.azimuth_from_mirror && !measurement->table) TurnAzimuths(measurement);
}

const std::vector<MeasurementFormat>& MeasurementFormats() {
  static const std::vector<MeasurementFormat> formats = {
#define TRILOBE_LIST(NAME) NAME##Format(),
      TRILOBE_FOR_EACH_FORMAT(TRILOBE_LIST)
#undef TRILOBE_LIST
  };
  return formats;
}

const MeasurementFormat* RecogniseFormat(std::string_view bytes) {
  constexpr size_t kBeginning = 1 << 16;  // by which a text is recognised
  const Content::Kind kind = RecogniseContent(bytes).kind;
  if (kind == Content::Kind::kForeign) return nullptr;
  const std::vector<MeasurementFormat>& formats = MeasurementFormats();
  const auto found = std::ranges::find_if(formats, [&](const MeasurementFormat& format) {
    if (format.is_json != (kind == Content::Kind::kJson)) return false;
    return format.recognise(format.is_text && !format.is_json ? bytes.substr(0, kBeginning)
                                                              : bytes);
  });
  return found == formats.end() ? nullptr : &*found;
}

void CheckMayBeJson(std::string_view bytes, const std::string& file, const std::string& otherwise) {
  const Content content = RecogniseContent(bytes);
  const MeasurementFormat* const format = RecogniseFormat(bytes);
  if (format == nullptr && content.kind != Content::Kind::kForeign) return;
  const std::string is = format == nullptr ? content.name : format->description;
  throw Error(ErrorKind::kFormat,
              file + (otherwise.empty() ? "" : ": " + otherwise) + ": this is " + is)
      .At(file)
      .About("content", is);
}

const MeasurementFormat& WritableFormat(const std::string& path) {
  const std::string ending = EndingOf(path);
  std::string known;
  for (const MeasurementFormat& format : MeasurementFormats()) {
    if (format.write == nullptr) continue;
    if (ending.empty() || ending == format.ending) return format;
    known += (known.empty() ? "" : ", ") + format.ending + " for " + format.written_as;
  }
  throw ErrorIn(ErrorKind::kUnsupported, path,
                "trilobe writes no '" + ending + "'; end the name in " + known)
      .About("ending", ending);
}

std::string WriteMeasurement(const Measurement& measurement, const std::string& path,
                             int num_threads, const BeforeRenaming& before_renaming) {
  const MeasurementFormat& format = WritableFormat(path);
  return format.written_as + ", " + format.write(measurement, path, num_threads, before_renaming);
}

bool IsSynthetic(std::string_view name) { return name.starts_with(kSynth); }

SynthSource SynthSourceOf(std::string_view name) {
  name.remove_prefix(kSynth.size());
  const size_t at = name.find('@');
  const SynthMaterial& material = FindSynthMaterial(name.substr(0, at));
  if (at == std::string_view::npos) {
    if (material.anisotropic) return {material, kUtiaGrid};
    return {material, MerlGrid()};
  }
  const std::string_view grid = name.substr(at + 1);
  if (std::ranges::count(grid, 'x') == 2) {
    if (material.anisotropic) {
      throw Error(
          ErrorKind::kUnsupported,
          "synth:" + std::string(name) + ": " + material.name +
              " is anisotropic, which a table by theta_h, theta_d and phi_d cannot hold; give "
              "the numbers of theta and phi of its directions, as 6x48")
          .At("synth:" + std::string(name))
          .About("anisotropic");
    }
    return {material, ParseMerlGrid(grid)};
  }
  return {material, ParseHemisphereGrid(grid)};
}

void DecideMeasured(const SourceOptions& options, BrdfTable* table) {
  CheckSourceOptions(options);
  NotNull(table, "the table");
  if (options.extrapolated) {
    table->unmeasured.clear();
    table->max_theta = kPi / 2;
  }
  LimitAngles(DegreesToRadians(options.max_angle_deg), Unmeasured::kBeyondMaxAngle, table);
  LimitThetaD(DegreesToRadians(options.min_theta_d_deg), table);
}

void DecideMeasured(const SourceOptions& options, Measurement* measurement) {
  CheckSourceOptions(options);
  LeaveOutAtRandom(options.missing, options.seed, measurement);
  if (measurement->table) {
    DecideMeasured(options, &*measurement->table);
    return;
  }
  LimitAngles(DegreesToRadians(options.max_angle_deg), measurement);
  LimitThetaD(DegreesToRadians(options.min_theta_d_deg), measurement);
}

Source::Source(std::string name) : name_(std::move(name)) {
  if (!synthetic()) bytes_ = ReadFile(name_);
}

Source::Source(std::string name, std::string bytes)
    : name_(std::move(name)), bytes_(std::move(bytes)) {}

bool Source::synthetic() const { return IsSynthetic(name_); }

std::string Source::Fingerprint() const { return synthetic() ? name_ : ContentHash(bytes_); }

Measurement Source::Parsed(const SourceOptions& options) const {
  const bool is_table = !options.columns.empty() || !options.rows.empty() ||
                        options.theta_i_deg != -1 || options.theta_o_deg != -1;
  std::string utf8 = Utf8OfUtf16(bytes_);
  if (RecogniseContent(utf8).kind == Content::Kind::kJson) utf8.clear();  // must be UTF-8
  const std::string_view bytes = utf8.empty() ? std::string_view{bytes_} : utf8;
  const MeasurementFormat& format = FormatOf(bytes, name_, is_table);
  Measurement measurement = format.read(bytes, name_, options);
  measurement.xxh128 = ContentHash(bytes_);
  if (!options.azimuth_from_mirror) TakeMerlBinsAsTable(&measurement);
  const bool is_rows = format.name == "json";  // of a text table
  NoteUnread(options, is_rows ? "csv" : format.name, &measurement);
  return measurement;
}

Measurement Source::Synthesized(const SourceOptions& options) const {
  const auto [material, grid] = SynthSourceOf(name_);
  Measurement measurement;
  if (const auto* const directions = std::get_if<HemisphereGrid>(&grid)) {
    measurement =
        SynthesizeSamples(material, options.noise, options.seed, *directions, options.num_threads);
    measurement.source = measurement.samples.source = name_;
  } else {
    measurement = {.source = name_,
                   .kind = "synthetic measurement",
                   .table = Synthesize(material, options.noise, options.seed,
                                       std::get<MerlGrid>(grid), options.num_threads)};
    measurement.table->source = name_;
  }
  NoteUnread(options, kSynth, &measurement);
  return measurement;
}

Measurement Source::Read(const SourceOptions& options) const {
  CheckSourceOptions(options);
  Measurement measurement = synthetic() ? Synthesized(options) : Parsed(options);
  CorruptBy(options, &measurement);
  const BrdfSamples& samples = measurement.samples;
  if (options.may_lack_values && !measurement.table && AllAreZero(samples)) {
    DecideMeasured(options, &measurement);
    return measurement;
  }
  // Judged by all that was measured: within a limit there may be no light to hold the shadow
  // against.
  if (options.min_theta_d_deg < 0) LeaveOutOwnShadow(&measurement);
  const MeasurementFormat* const format = synthetic() ? nullptr : RecogniseFormat(bytes_);
  DropBadReadings(options, format != nullptr && format->name == "rgl", &measurement);
  DecideMeasured(options, &measurement);
  return measurement;
}

Measurement LoadMeasurement(const std::string& name, const SourceOptions& options) {
  CheckSourceOptions(options);  // before a large file is read
  return Source(name).Read(options);
}

BrdfTable LoadTable(const std::string& name, const SourceOptions& options) {
  return TableOf(LoadMeasurement(name, options));
}

}  // namespace trilobe
