#include "app/inputs.h"

#include <algorithm>
#include <iterator>
#include <string_view>

#include "app/flags.h"
#include "core/files/content.h"
#include "core/files/file.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/load_model.h"

namespace trilobe {

bool IsModelFile(const std::string& path) {
  if (IsMaterial(path)) return true;
  const std::string beginning = BeginningOf(path);
  if (RecogniseContent(beginning).kind != Content::Kind::kJson) return false;
  // Objects of other keys are read as measurements, which says what columns they lack.
  const bool has_keys =
      beginning.find("\":") != std::string::npos || beginning.starts_with("{\\rtf");
  const bool is_model = beginning.find("\"format\"") != std::string::npos ||
                        beginning.find("\"lobes\"") != std::string::npos;
  return (is_model || !has_keys) && RecogniseFormat(beginning) == nullptr &&
         EndingOf(path) != ".xompt";
}

ModelFile ModelOfSource(const std::string& path) {
  if (!IsMaterial(path)) CheckMayBeJson(BeginningOf(path), path, "not a model file");
  return LoadModel(path);
}

void RefuseMaterial(const std::string& source) {
  if (!IsMaterial(source)) return;
  throw ErrorIn(ErrorKind::kUnsupported, source,
                "this is a model; give the file of a measurement, or synth:NAME");
}

Measurement MeasurementOfSource(const std::string& source, const SourceOptions& options) {
  RefuseMaterial(source);
  return LoadMeasurement(source, options);
}

std::string RequiredOut(const std::string& command, const std::string& what) {
  if (FLAGS_out.empty()) {
    throw Error(ErrorKind::kMissing,
                "trilobe " + command + " needs --out=" + what + ", to know where to write")
        .About("out");
  }
  return FLAGS_out;
}

void CheckPictureOut() {
  const std::string ending = EndingOf(FLAGS_out);
  if (ending.empty() || ending == ".png") return;
  throw Error(ErrorKind::kUnsupported,
              "--out=" + FLAGS_out + ": the picture is a PNG; end the name in .png")
      .About("out", FLAGS_out);
}

std::string RequiredMeasurementOut(const std::string& command) {
  std::string out = RequiredOut(command, "FILE");
  try {
    WritableFormat(out);
  } catch (const Error& error) {
    throw error.WithMessage("--out=" + std::string(error.what()) +
                            (command == "convert"
                                 ? ", or in .bsdf, .zemax.bsdf, .xml, .xompt, .glsl, .hlsl, "
                                   ".mtlx, .principled.json, .gltf or .usda for "
                                   "renderers and optical design"
                                 : ""));
  }
  return out;
}

}  // namespace trilobe
