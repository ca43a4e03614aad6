#include "trilobe/io/source.h"

#include <string_view>

#include "trilobe/base/error.h"
#include "trilobe/io/file.h"
#include "trilobe/io/merl_file.h"
#include "trilobe/io/model_file.h"
#include "trilobe/io/rgl_file.h"
#include "trilobe/io/synth.h"

namespace trilobe {
BrdfTable LoadSource(const std::string& source, const SourceOptions& options) {
  constexpr std::string_view kSynth = "synth:";
  if (source.starts_with(kSynth)) {
    BrdfTable table = Synthesize(FindSynthMaterial(source.substr(kSynth.size())), options.noise,
                                 options.seed, {}, options.num_threads);
    table.source = source;
    return table;
  }
  const std::string bytes = ReadFile(source);
  if (LooksLikeRgl(bytes)) {
    return TabulateRgl(RglBrdf::Parse(bytes, source), source, {}, options.num_threads);
  }
  if (LooksLikeModel(bytes)) {
    throw Error(source +
                ": this is a JSON file, as a fitted model is, and not a measurement; give a MERL "
                ".binary file, an RGL *_rgb.bsdf file, or synth:NAME");
  }
  return ParseMerl(bytes, source);
}

}  // namespace trilobe
