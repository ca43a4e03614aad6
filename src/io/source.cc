#include "trilobe/io/source.h"

#include <algorithm>
#include <memory>

#include "trilobe/base/error.h"
#include "trilobe/io/astm_file.h"
#include "trilobe/io/content.h"
#include "trilobe/io/cornell_file.h"
#include "trilobe/io/csv_file.h"
#include "trilobe/io/file.h"
#include "trilobe/io/mbsdf_file.h"
#include "trilobe/io/merl_file.h"
#include "trilobe/io/synth.h"
#ifdef TRILOBE_RGL
#include "trilobe/io/rgl_file.h"
#endif

namespace trilobe {
namespace {

constexpr std::string_view kSynth = "synth:";

template <Content::Kind kKind>
bool Is(std::string_view bytes) {
  return RecogniseContent(bytes).kind == kKind;
}

Measurement ReadMerl(std::string_view bytes, const std::string& source, int /*num_threads*/) {
  return {.source = source, .kind = "MERL measurement", .table = ParseMerl(bytes, source)};
}

#ifdef TRILOBE_RGL
Measurement ReadRgl(std::string_view bytes, const std::string& source, int num_threads) {
  auto rgl = std::make_shared<const RglBrdf>(RglBrdf::Parse(bytes, source));
  return {.source = source,
          .kind = "RGL measurement, at MERL bins",
          .table = TabulateRgl(*rgl, source, {}, num_threads),
          .rgl = rgl};
}
#endif

// A reader that has no use for threads.
template <Measurement (*kParse)(std::string_view, const std::string&)>
Measurement Read(std::string_view bytes, const std::string& source, int /*num_threads*/) {
  return kParse(bytes, source);
}

// "a MERL .binary file, ... or synth:NAME".
std::string WhatMeasurementsAre() {
  std::string text;
  for (const MeasurementFormat& format : MeasurementFormats()) text += format.description + ", ";
  return text + "or synth:NAME";
}

const MeasurementFormat& FormatOf(std::string_view bytes, const std::string& source) {
  const std::vector<MeasurementFormat>& formats = MeasurementFormats();
  auto found = std::ranges::find_if(
      formats, [&](const MeasurementFormat& format) { return format.recognise(bytes); });
  if (found != formats.end()) return *found;
  const Content content = RecogniseContent(bytes);
  if (content.kind == Content::Kind::kText) {
    const std::string ending = EndingOf(source);
    found = std::ranges::find_if(formats, [&](const MeasurementFormat& format) {
      return format.is_text && format.ending == ending;
    });
    if (found != formats.end()) return *found;
  }
  if (content.kind != Content::Kind::kUnknown) {
    throw Error(source + ": this is " + content.name + "; a measurement is " +
                WhatMeasurementsAre());
  }
  return formats.front();  // MERL: it says what is wrong with its header
}

}  // namespace

const std::vector<MeasurementFormat>& MeasurementFormats() {
  using Kind = Content::Kind;
  static const std::vector<MeasurementFormat> formats = {
      {"merl", "a MERL .binary file", ".binary", false, Is<Kind::kMerl>, ReadMerl},
#ifdef TRILOBE_RGL
      {"rgl", "an RGL *_rgb.bsdf file", ".bsdf", false, Is<Kind::kTensor>, ReadRgl},
#endif
      {"mbsdf", "an MDL .mbsdf file", ".mbsdf", false, Is<Kind::kMbsdf>, Read<ParseMbsdf>},
      {"cornell", "a Cornell .brdf file of spectra", ".brdf", true, Is<Kind::kCornell>,
       Read<ParseCornell>},
      {"astm", "an ASTM E1392 .astm file", ".astm", true, Is<Kind::kAstm>, Read<ParseAstm>},
      {"csv", "a .csv file of samples", ".csv", true, Is<Kind::kCsv>, Read<ParseCsv>},
  };
  return formats;
}

bool IsSynthetic(std::string_view source) { return source.starts_with(kSynth); }

const SynthMaterial& SynthMaterialOf(std::string_view source) {
  return FindSynthMaterial(source.substr(kSynth.size()));
}

void DecideMeasured(const SourceOptions& options, BrdfTable* table) {
  if (options.extrapolated) {
    table->unmeasured.clear();
    table->max_theta = kPi / 2;
  }
  LimitAngles(DegreesToRadians(options.max_angle_deg), Unmeasured::kBeyondMaxAngle, table);
}

void DecideMeasured(const SourceOptions& options, Measurement* measurement) {
  if (measurement->table) {
    DecideMeasured(options, &*measurement->table);
  } else {
    LimitAngles(DegreesToRadians(options.max_angle_deg), measurement);
  }
}

Measurement ParseMeasurement(std::string_view bytes, const std::string& source,
                             const SourceOptions& options) {
  Measurement measurement = FormatOf(bytes, source).read(bytes, source, options.num_threads);
  DecideMeasured(options, &measurement);
  return measurement;
}

BrdfTable ParseSource(std::string_view bytes, const std::string& source,
                      const SourceOptions& options) {
  return TableOf(ParseMeasurement(bytes, source, options));
}

Measurement LoadMeasurement(const std::string& source, const SourceOptions& options) {
  if (!IsSynthetic(source)) return ParseMeasurement(ReadFile(source), source, options);
  Measurement measurement{.source = source,
                          .kind = "synthetic measurement",
                          .table = Synthesize(SynthMaterialOf(source), options.noise, options.seed,
                                              {}, options.num_threads)};
  measurement.table->source = source;
  DecideMeasured(options, &measurement);
  return measurement;
}

BrdfTable LoadSource(const std::string& source, const SourceOptions& options) {
  return TableOf(LoadMeasurement(source, options));
}

}  // namespace trilobe
