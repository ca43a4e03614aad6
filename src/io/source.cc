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
#include "trilobe/io/utia_file.h"
#include "trilobe/io/zemax_file.h"
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

Measurement ReadMerl(std::string_view bytes, const std::string& source,
                     const SourceOptions& /*options*/) {
  return {.source = source, .kind = "MERL measurement", .table = ParseMerl(bytes, source)};
}

#ifdef TRILOBE_RGL
Measurement ReadRgl(std::string_view bytes, const std::string& source,
                    const SourceOptions& options) {
  auto rgl = std::make_shared<const RglBrdf>(RglBrdf::Parse(bytes, source));
  if (!rgl->isotropic()) {
    Measurement measurement = rgl->Sample(source, options.extrapolated);
    measurement.rgl = std::move(rgl);
    return measurement;
  }
  return {.source = source,
          .kind = "RGL measurement, at MERL bins",
          .table = TabulateRgl(*rgl, source, {}, options.num_threads),
          .rgl = rgl};
}
#endif

Measurement ReadUtia(std::string_view bytes, const std::string& source,
                     const SourceOptions& options) {
  return ParseUtia(bytes, source, options.radiometry);
}

// A reader that has no use for options.
template <Measurement (*kParse)(std::string_view, const std::string&)>
Measurement Read(std::string_view bytes, const std::string& source,
                 const SourceOptions& /*options*/) {
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
  const bool is_text = content.kind == Content::Kind::kText;
  if (is_text || content.kind == Content::Kind::kUnknown) {
    const std::string ending = EndingOf(source);
    found = std::ranges::find_if(formats, [&](const MeasurementFormat& format) {
      return (bytes.empty() || format.is_text == is_text) && format.ending == ending;
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
      {"utia", "a UTIA .bin file", ".bin", false, Is<Kind::kUtia>, ReadUtia},
      {"zemax", "a Zemax .bsdf file", ".bsdf", true, Is<Kind::kZemax>, Read<ParseZemax>},
      {"cornell", "a Cornell .brdf file of spectra", ".brdf", true, Is<Kind::kCornell>,
       Read<ParseCornell>},
      {"astm", "an ASTM E1392 .astm file", ".astm", true, Is<Kind::kAstm>, Read<ParseAstm>},
      {"csv", "a .csv file of samples", ".csv", true, Is<Kind::kCsv>, Read<ParseCsv>},
  };
  return formats;
}

bool IsSynthetic(std::string_view source) { return source.starts_with(kSynth); }

SynthSource SynthSourceOf(std::string_view source) {
  const std::string_view name = source.substr(kSynth.size());
  const size_t at = name.find('@');
  const SynthMaterial& material = FindSynthMaterial(name.substr(0, at));
  if (at != std::string_view::npos) return {material, ParseHemisphereGrid(name.substr(at + 1))};
  return {material, material.anisotropic ? std::optional(kUtiaGrid) : std::nullopt};
}

void DecideMeasured(const SourceOptions& options, BrdfTable* table) {
  if (options.extrapolated) {
    table->unmeasured.clear();
    table->max_theta = kPi / 2;
  }
  LimitAngles(DegreesToRadians(options.max_angle_deg), Unmeasured::kBeyondMaxAngle, table);
  LimitThetaD(DegreesToRadians(options.min_theta_d_deg), table);
}

void DecideMeasured(const SourceOptions& options, Measurement* measurement) {
  LeaveOutAtRandom(options.missing, options.seed, measurement);
  if (measurement->table) {
    DecideMeasured(options, &*measurement->table);
    return;
  }
  LimitAngles(DegreesToRadians(options.max_angle_deg), measurement);
  LimitThetaD(DegreesToRadians(options.min_theta_d_deg), measurement);
}

Measurement ParseMeasurement(std::string_view bytes, const std::string& source,
                             const SourceOptions& options) {
  Measurement measurement = FormatOf(bytes, source).read(bytes, source, options);
  // Of all that was measured: within a limit there may be no light to hold the shadow against.
  if (options.min_theta_d_deg < 0) LeaveOutOwnShadow(&measurement);
  DecideMeasured(options, &measurement);
  return measurement;
}

BrdfTable ParseSource(std::string_view bytes, const std::string& source,
                      const SourceOptions& options) {
  return TableOf(ParseMeasurement(bytes, source, options));
}

Measurement LoadMeasurement(const std::string& source, const SourceOptions& options) {
  if (!IsSynthetic(source)) return ParseMeasurement(ReadFile(source), source, options);
  const auto [material, grid] = SynthSourceOf(source);
  Measurement measurement;
  if (grid) {
    measurement =
        SynthesizeSamples(material, options.noise, options.seed, *grid, options.num_threads);
    measurement.source = measurement.samples.source = source;
  } else {
    measurement = {
        .source = source,
        .kind = "synthetic measurement",
        .table = Synthesize(material, options.noise, options.seed, {}, options.num_threads)};
    measurement.table->source = source;
  }
  DecideMeasured(options, &measurement);
  return measurement;
}

BrdfTable LoadSource(const std::string& source, const SourceOptions& options) {
  return TableOf(LoadMeasurement(source, options));
}

}  // namespace trilobe
