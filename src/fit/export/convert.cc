#include "trilobe/fit/export/convert.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>
#include <optional>
#include <ostream>
#include <string_view>

#include "core/base/file_names.h"
#include "core/base/text.h"
#include "core/files/file.h"
#include "core/system/process.h"
#include "fit/export/gltf_material.h"
#include "fit/export/nearest_open_pbr.h"
#include "fit/export/open_pbr.h"
#include "fit/export/usd_material.h"
#include "io/formats/completed_measurement.h"
#include "io/formats/databases/utia_file.h"
#include "io/formats/exports/exported_brdf.h"
#include "io/formats/exports/klems_export.h"
#include "io/formats/exports/open_material_export.h"
#include "io/formats/exports/rgl_export.h"
#include "io/formats/exports/zemax_export.h"
#include "io/pictures/plots.h"
#include "io/pictures/shader_file.h"
#include "model/appearance/picture_data.h"
#include "model/appearance/verdict.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/base/error.h"
#include "trilobe/fit/as_measurement.h"
#include "trilobe/fit/fit.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/albedo.h"

namespace trilobe {
namespace {

constexpr const char* kRgb = "RGB";
constexpr const char* kMadeSpectra = "spectra";  // made of RGB
constexpr const char* kTensorEnding = ".bsdf";
constexpr const char* kZemaxEnding = ".zemax.bsdf";
constexpr const char* kKlemsEnding = ".xml";
constexpr const char* kOpenMaterialEnding = ".xompt";
constexpr const char* kGlslEnding = ".glsl";
constexpr const char* kHlslEnding = ".hlsl";
constexpr const char* kMaterialXEnding = ".mtlx";
constexpr const char* kPrincipledEnding = ".principled.json";
constexpr const char* kGltfEnding = ".gltf";
constexpr const char* kUsdEnding = ".usda";

bool EndsIn(const std::string& path, const std::string& ending) {
  if (path.size() <= ending.size()) return false;
  std::string last = path.substr(path.size() - ending.size());
  std::ranges::transform(last, last.begin(), [](unsigned char c) { return std::tolower(c); });
  return last == ending;
}

bool IsShader(const std::string& path) {
  return EndingOf(path) == kGlslEnding || EndingOf(path) == kHlslEnding;
}

std::optional<double> MaxErrorOf(const ConvertOptions& options) {
  if (!(options.error >= 0 && options.error <= 1)) {
    throw Error(ErrorKind::kRange, "error must be from 0 to 1").About("error", options.error);
  }
  if (options.error == 0) return std::nullopt;
  return options.error;
}

RglExportOptions RglOptionsOf(const ConvertOptions& options) {
  return {.max_error = MaxErrorOf(options), .spectral = options.spectral};
}

double MaxAngleOf(const ModelFile& file) {  // [degrees]
  return file.fit.max_angle > 0 ? file.fit.max_angle : 90;
}

// ", off the model by 0.4 % in the median and 3 % for one of a hundred directions". `than`: what
// the file may be off, "the model".
std::string HowFarOff(const std::string& than, double median_error, double high_error,
                      double max_angle) {
  std::string text = ", off " + than + " by " + Text(100 * median_error, 2) +
                     " % in the median and " + Text(100 * high_error, 2) +
                     " % for one of a hundred directions";
  if (max_angle < 90) text += ", within the " + Text(max_angle) + " deg that were measured";
  return text;
}

std::string InMegabytes(const std::string& bytes) {
  return Text(static_cast<double>(bytes.size()) / 1e6, 2) + " MB";
}

// `content`: "RGB".
std::string WriteTensorFile(const RglExport& file, const std::string& than, double max_angle,
                            const std::string& content, const std::string& path) {
  WriteFile(path, [&](std::ostream& out) { out << file.bytes; });
  std::string line = "wrote " + path + ": RGL tensor file of " + content + ", " +
                     InMegabytes(file.bytes) +
                     HowFarOff(than, file.median_error, file.high_error, max_angle);
  if (content == kMadeSpectra) {
    line += "; colours of spectra off by " + Text(100 * file.color_error, 2) + " % at most";
    if (file.colors_off > 0) {
      line += ", by more than 0.1 % for " + Text(100 * file.colors_off, 2) +
              " % of them, which are too saturated";
    }
  }
  return line;
}

// Writes Klems matrices, OpenMATERIAL's or OpticStudio's table, by the ending of `path`.
std::string WriteExported(const ExportedBrdf& brdf, const std::string& than, double max_angle,
                          const ConvertOptions& options, const std::string& path) {
  const auto write = [&](const auto& file, const std::string& what, const std::string& colors) {
    WriteFile(path, [&](std::ostream& out) { out << file.bytes; });
    return "wrote " + path + ": " + what + ", " + (file.colored ? colors : "one channel") + ", " +
           InMegabytes(file.bytes) + HowFarOff(than, file.median_error, file.high_error, max_angle);
  };
  const std::string name = std::filesystem::path(path).stem().string();
  if (EndingOf(path) == kOpenMaterialEnding) {
    const OpenMaterialExport file = ExportOpenMaterial(brdf, name, options.num_threads);
    return write(file,
                 "OpenMATERIAL 3D table of " + std::to_string(file.incidences) + " incidences, " +
                     std::to_string(file.zeniths) + " x " + std::to_string(file.azimuths) +
                     " directions",
                 "7 wavelengths");
  }
  if (EndingOf(path) == kKlemsEnding) {
    return write(ExportKlems(brdf, name, options.num_threads),
                 "means over pairs of patches of the full Klems basis", "XYZ");
  }
  const ZemaxExport file =
      ExportZemax(brdf, {.max_error = MaxErrorOf(options), .num_threads = options.num_threads});
  std::string angles = std::to_string(file.incidences) + " incidences, " +
                       std::to_string(file.azimuths) + " x " + std::to_string(file.radials) +
                       " directions";
  if (file.rotations > 1) angles = std::to_string(file.rotations) + " rotations, " + angles;
  return write(file, "Zemax BSDF of " + angles, "XYZ");
}

// A file of the nearest standard material.
struct StandardFormat {
  const char* ending;
  StandardShading shading;
  const char* nearest;  // what the nearest one is called
  std::string (*format)(const OpenPbr&, const MaterialNotes&);
  std::string (*told)(const OpenPbr&);  // what it has
};

const StandardFormat* StandardFormatOf(const std::string& path) {
  static const StandardFormat formats[] = {
      {kMaterialXEnding, StandardShading::kOpenPbr, "OpenPBR", FormatMaterialX,
       [](const OpenPbr& /*material*/) { return std::string("open_pbr_surface"); }},
      {kPrincipledEnding, StandardShading::kOpenPbr, "OpenPBR", FormatPrincipled,
       [](const OpenPbr& /*material*/) {
         return std::string("inputs of Blender's Principled BSDF");
       }},
      {kGltfEnding, StandardShading::kGltf, "material of glTF", FormatGltf, EngineText},
      {kUsdEnding, StandardShading::kPreviewSurface, "UsdPreviewSurface", FormatUsd, EngineText}};
  const auto found = std::ranges::find_if(
      formats, [&](const StandardFormat& format) { return EndsIn(path, format.ending); });
  return found == std::end(formats) ? nullptr : found;
}

// The two, side by side.
void DrawStandard(const FactorModel& model, const std::string& source, double max_angle,
                  const BrdfFunction& brdf, const std::string& path, AppearanceOptions options) {
  options.size = 160;  // half the pixels of each sphere
  Measurement shown = AsMeasurement(model, source, options.num_threads, kUtiaGrid);
  LimitAngles(DegreesToRadians(max_angle), &shown);
  const Material material = {[&](const HalfDiffAngles& angles, const Cosines& /*cosines*/) {
                               return brdf(ToDirections(angles));
                             },
                             [&](const SphericalAngles& at) { return brdf(ToDirections(at)); }};
  WriteSpherePair(PictureDataOf(shown), material, path, options,
                  {.left = Word::kModel, .right = Word::kFile});
}

// ", fitted to silk.bsdf (XXH128 ...)", for a model that knows it.
std::string FittedTo(const ModelFile& file, const std::string& source) {
  const FitInfo& fit = file.fit;
  const std::string measured = FileNameOf(fit.source);
  const bool other = !measured.empty() && measured != FileNameOf(source);
  return (other ? ", fitted to " + measured : "") +
         (fit.source_xxh128.empty() ? "" : " (XXH128 " + fit.source_xxh128 + ")");
}

// Writes the nearest material of renderers that have no other to a model.
std::vector<std::string> WriteStandard(const ModelFile& file, const std::string& source,
                                       const std::string& path, const ConvertOptions& options) {
  const StandardFormat& format = *StandardFormatOf(path);
  const double max_angle = MaxAngleOf(file);
  Stopwatch stopwatch;
  options.on_stage(std::string("finding the nearest ") + format.nearest);
  const NearestOpenPbr nearest = FindNearestOpenPbr(file.model, DegreesToRadians(max_angle),
                                                    options.appearance, format.shading);
  const SphereError& error = nearest.error;
  const std::string name = std::filesystem::path(path).filename().string();
  const MaterialNotes notes = {
      .name = name.substr(0, name.size() - std::string_view(format.ending).size()),
      .made = std::string("the nearest ") + format.nearest + " to " + FileNameOf(source) +
              FittedTo(file, source) + ", found by " + options.program,
      .error = "beside it on a sphere Delta E is " + Text(error.mean_delta_e, 2) +
               " in the mean, below " + Text(error.delta_e_95, 2) + " for 95 %, PSNR " +
               Text(error.psnr_db, 3) + " dB",
      .lost = VerdictOf(error).visibility == Visibility::kNone
                  ? "lost against the model: nothing to be seen"
                  : "lost against the model, " + Words(VerdictOf(error))};
  const std::string text = format.format(nearest.material, notes);
  WriteFile(path, [&](std::ostream& out) { out << text; });
  std::vector<std::string> lines = {"wrote " + path + ": " + format.told(nearest.material) + ", " +
                                    notes.error + "; " + notes.lost + " (" +
                                    Text(stopwatch.Lap(), 2) + " s)"};
  if (!options.picture.empty()) {
    DrawStandard(file.model, source, max_angle, StandardBrdf(format.shading, nearest.material),
                 options.picture, options.appearance);
    lines.push_back("wrote " + options.picture + ": the model, and what the file has");
  }
  return lines;
}

// The model by whose help a measurement becomes a function of all directions. Further iterations
// lower E by little, and the measured values of the file not at all.
FitResult FitToHelp(const Measurement& measurement, const ConvertOptions& convert) {
  FitOptions options;
  options.compare = false;
  options.solver_options = [](const ModelSpec& /*spec*/) {
    return SolverOptions{.max_iterations = 4};
  };
  options.match_reflectance = false;
  options.num_threads = convert.num_threads;
  options.on_stage = convert.on_stage;
  return Fit(measurement, options);
}

}  // namespace

bool IsForRenderer(const std::string& path) {
  const std::string ending = EndingOf(path);
  return ending == kTensorEnding || IsShader(path) || ending == kKlemsEnding ||
         ending == kOpenMaterialEnding || IsStandardMaterial(path);
}

bool IsTensorFile(const std::string& path) {
  return EndingOf(path) == kTensorEnding && !EndsIn(path, kZemaxEnding);
}

bool TakesError(const std::string& path) { return EndingOf(path) == kTensorEnding; }

bool IsStandardMaterial(const std::string& path) { return StandardFormatOf(path) != nullptr; }

std::vector<std::string> WriteForRenderer(const ModelFile& file, const std::string& source,
                                          const std::string& path, const ConvertOptions& options) {
  if (IsStandardMaterial(path)) return WriteStandard(file, source, path, options);
  if (IsShader(path)) {
    const bool glsl = EndingOf(path) == kGlslEnding;
    const ShaderFile shader =
        FormatShader(file, source, glsl ? ShaderLanguage::kGlsl : ShaderLanguage::kHlsl);
    WriteFile(path, [&](std::ostream& out) { out << shader.text; });
    return {"wrote " + path + (glsl ? ": GLSL ES 3.00" : ": HLSL") + " with a texture of " +
            std::to_string(shader.width) + " x " + std::to_string(shader.height) + ", " +
            Text(static_cast<double>(shader.text.size()) / 1e6, 2) + " MB"};
  }
  const double max_angle = MaxAngleOf(file), max_theta = DegreesToRadians(max_angle);
  options.on_stage("writing " + path);
  if (!IsTensorFile(path)) {
    return {
        WriteExported(ExportedModel(file.model, max_theta), "the model", max_angle, options, path)};
  }
  RglExportOptions rgl = RglOptionsOf(options);
  rgl.max_theta = max_theta;
  if (file.spectral && options.spectral) {
    return {WriteTensorFile(ExportRgl(*file.spectral, rgl), "the model", max_angle,
                            WavelengthsText(*file.spectral), path)};
  }
  return {WriteTensorFile(ExportRgl(file.model, rgl), "the model", max_angle,
                          options.spectral ? kMadeSpectra : kRgb, path)};
}

std::vector<std::string> WriteForRenderer(const Measurement& measurement, const std::string& path,
                                          const ConvertOptions& options) {
  if (IsShader(path)) {
    throw Error(ErrorKind::kUnsupported,
                path + ": " + measurement.source +
                    " is a measurement, and shaders are made of models; fit it first")
        .At(measurement.source)
        .About("shader");
  }
  RglExportOptions rgl = RglOptionsOf(options);
  Stopwatch stopwatch;
  const FitResult fit = FitToHelp(measurement, options);
  const std::string fitted =
      "fitted " + measurement.source + " by " + std::to_string(fit.stored_parameters) +
      " parameters, in " + Text(stopwatch.Lap(), 2) +
      " s (`trilobe fit` once, and convert its model.json, for several files)";
  if (IsStandardMaterial(path)) {
    std::vector<std::string> lines = WriteStandard(fit.file, measurement.source, path, options);
    lines.insert(lines.begin(), fitted);
    return lines;
  }
  options.on_stage("filling in what was not measured");
  const CompletedMeasurement completed = Complete(measurement, fit.model(), options.num_threads);
  const double measured = MaxAngleDegrees(measurement);
  const std::string than =
      completed.interpolated
          ? "the measurement"
          : "the measurement (whose samples stand at no grid: it is the fitted model)";
  std::vector<std::string> lines = {fitted + ", for where nothing was measured"};
  options.on_stage("writing " + path);
  if (IsTensorFile(path)) {
    rgl.max_theta = DegreesToRadians(measured);
    lines.push_back(WriteTensorFile(ExportRgl(fit.model(), completed, rgl), than, measured,
                                    options.spectral ? kMadeSpectra : kRgb, path));
  } else {
    lines.push_back(
        WriteExported({completed.value, fit.model().spec().anisotropic(), completed.places}, than,
                      measured, options, path));
  }
  return lines;
}

}  // namespace trilobe
