#include "trilobe/io/source.h"

#include "trilobe/base/error.h"
#include "trilobe/io/file.h"
#include "trilobe/io/merl_file.h"
#include "trilobe/io/model_file.h"
#include "trilobe/io/synth.h"
#ifdef TRILOBE_RGL
#include "trilobe/io/rgl_file.h"
#endif

namespace trilobe {
namespace {

constexpr std::string_view kSynth = "synth:";

}  // namespace

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

BrdfTable ParseSource(std::string_view bytes, const std::string& source,
                      const SourceOptions& options) {
#ifdef TRILOBE_RGL
  if (LooksLikeRgl(bytes)) {
    BrdfTable table = TabulateRgl(RglBrdf::Parse(bytes, source), source, {}, options.num_threads);
    DecideMeasured(options, &table);
    return table;
  }
#endif
  BrdfTable table = ParseMerl(bytes, source);
  DecideMeasured(options, &table);
  return table;
}

BrdfTable LoadSource(const std::string& source, const SourceOptions& options) {
  if (!IsSynthetic(source)) return ParseSource(ReadFile(source), source, options);
  BrdfTable table =
      Synthesize(SynthMaterialOf(source), options.noise, options.seed, {}, options.num_threads);
  table.source = source;
  DecideMeasured(options, &table);
  return table;
}

}  // namespace trilobe
