#include "app/write_for_renderer.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <ostream>
#include <system_error>

#include "app/appearance_flags.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "app/materials.h"
#include "app/program.h"
#include "app/result_folder.h"
#include "appearance/verdict.h"
#include "files/file.h"
#include "reports/print.h"
#include "standard/material_files.h"
#include "standard/nearest_open_pbr.h"
#include "standard/open_pbr.h"
#include "system/stopwatch.h"
#include "trilobe/appearance/node_reconstruction.h"
#include "trilobe/appearance/picture_data.h"
#include "trilobe/base/error.h"
#include "trilobe/fit/fit.h"
#include "trilobe/formats/completed_measurement.h"
#include "trilobe/formats/rgl_export.h"
#include "trilobe/formats/source.h"
#include "trilobe/formats/utia_file.h"
#include "trilobe/lobes/reconstruct.h"
#include "trilobe/pictures/plots.h"
#include "trilobe/results/model_file.h"
#include "view/glsl_file.h"

DEFINE_double(error, 0,
              "of a .bsdf file: how far it may be off the model or the measurement, relative, in "
              "the median over directions; finer tables are taken until it is met. 0: 0.005, of an "
              "anisotropic model 0.02, or as near as files come, and of a measurement as files of "
              "usual size come");
DEFINE_bool(spectral, false,
            "of a .bsdf file: spectra in place of RGB, for spectral renderers (Mitsuba's spectral "
            "variants, pbrt-v4); the others cannot read it");

DEFINE_bool(picture, false,
            "of a .mtlx or .principled.json file: draws the model and what the file has, side by "
            "side, beside it, as .png");

namespace trilobe {
namespace {

constexpr const char* kTensorEnding = ".bsdf";
constexpr const char* kShaderEnding = ".glsl";
constexpr const char* kMaterialXEnding = ".mtlx";
constexpr const char* kPrincipledEnding = ".principled.json";

bool EndsIn(const std::string& path, const std::string& ending) {
  if (path.size() <= ending.size()) return false;
  std::string last = path.substr(path.size() - ending.size());
  std::ranges::transform(last, last.begin(), [](unsigned char c) { return std::tolower(c); });
  return last == ending;
}
bool IsStandard(const std::string& path) {
  return EndsIn(path, kMaterialXEnding) || EndsIn(path, kPrincipledEnding);
}

struct Exported {
  RglExport file;
  std::string than;  // what it may be off, "the model"
  double max_angle = 90;
};

Exported ExportModel(const std::string& path, RglExportOptions options) {
  RefuseForModel(path, MeasurementFlags());
  const ModelFile model = LoadModel(path);
  const double measured = model.fit.max_angle > 0 ? model.fit.max_angle : 90;  // [degrees]
  options.max_theta = DegreesToRadians(measured);
  return {ExportRgl(model.model, options), "the model", measured};
}

// The model that its tables are made of is fitted here; nothing else is done with it.
Exported ExportMeasurement(const std::string& source, RglExportOptions options) {
  const SourceOptions source_options = SourceOptionsFromFlags();
  const Measurement measurement = LoadMeasurement(source, source_options);
  TellNotes(measurement);
  Stopwatch stopwatch;
  FitOptions fit_options;
  fit_options.compare = false;
  // Further ones lower E by little, and the values of the file not at all.
  fit_options.solver_options = [](const ModelSpec& /*spec*/) {
    return SolverOptions{.max_iterations = 4};
  };
  fit_options.match_reflectance = false;
  fit_options.num_threads = source_options.num_threads;
  const FitResult fit = Fit(measurement, fit_options);
  PrintLine("fitted " + source + " by " + std::to_string(fit.stored_parameters) +
            " parameters, in " + Text(stopwatch.Lap(), 2) + " s, for where nothing was measured");
  const CompletedMeasurement completed =
      Complete(measurement, fit.model(), source_options.num_threads);
  const double measured = MaxAngleDegrees(measurement);
  options.max_theta = DegreesToRadians(measured);
  return {ExportRgl(fit.model(), completed, options),
          completed.interpolated
              ? "the measurement"
              : "the measurement (whose samples stand at no grid: it is the fitted model)",
          measured};
}

// What can be known to fail is told before a fit, which takes seconds.
void CheckOut(const std::string& source) {
  Inputs({source}).CheckOutput(FLAGS_out);
  const std::filesystem::path folder = std::filesystem::path(FLAGS_out).parent_path();
  std::error_code ignored;
  if (!folder.empty() && !std::filesystem::is_directory(folder, ignored)) {
    throw Error("cannot write '" + FLAGS_out + "': there is no folder '" + folder.string() +
                "'; make it first");
  }
}

void WriteTensorFile(const std::string& source) {
  if (!(FLAGS_error >= 0 && FLAGS_error <= 1)) throw Error("--error must be from 0 to 1");
  CheckOut(source);
  RglExportOptions options{.spectral = FLAGS_spectral};
  if (FLAGS_error > 0) options.max_error = FLAGS_error;
  const Exported exported =
      IsModelFile(source) ? ExportModel(source, options) : ExportMeasurement(source, options);
  const RglExport& file = exported.file;
  WriteFile(FLAGS_out, [&](std::ostream& out) { out << file.bytes; });
  std::string line =
      "wrote " + FLAGS_out + ": RGL tensor file of " + (FLAGS_spectral ? "spectra, " : "RGB, ") +
      Text(static_cast<double>(file.bytes.size()) / 1e6, 2) + " MB, off " + exported.than + " by " +
      Text(100 * file.median_error, 2) + " % in the median and " + Text(100 * file.high_error, 2) +
      " % for one of a hundred directions";
  if (exported.max_angle < 90) {
    line += ", within the " + Text(exported.max_angle) + " deg that were measured";
  }
  if (FLAGS_spectral) {
    line += "; colours of spectra off by " + Text(100 * file.color_error, 2) + " % at most";
    if (file.colors_off > 0) {
      line += ", by more than 0.1 % for " + Text(100 * file.colors_off, 2) +
              " % of them, which are too saturated";
    }
  }
  PrintLine(line);
}

// A file that is made of a model alone: its errors before any work.
ModelFile ModelFor(const std::string& source, const std::string& ending) {
  if (!IsModelFile(source)) {
    LoadMeasurement(source);  // or an error that says why it is not even that
    throw Error("--out=" + FLAGS_out + ": " + source + " is a measurement, and trilobe writes " +
                ending + " files of models; fit it first");
  }
  RefuseForModel(source, MeasurementFlags());
  CheckOut(source);
  return LoadModel(source);
}

void WriteShader(const std::string& source) {
  const GlslFile file = FormatGlsl(ModelFor(source, kShaderEnding), source);
  WriteFile(FLAGS_out, [&](std::ostream& out) { out << file.text; });
  PrintLine("wrote " + FLAGS_out + ": GLSL ES 3.00 with a texture of " +
            std::to_string(file.width) + " x " + std::to_string(file.height) + ", " +
            Text(static_cast<double>(file.text.size()) / 1e6, 2) + " MB");
}

// The two, side by side.
void DrawStandard(const FactorModel& model, const std::string& source, double max_angle,
                  const OpenPbrBrdf& brdf, const std::string& path,
                  const AppearanceOptions& options) {
  Measurement shown;
  if (model.spec().anisotropic()) {
    shown = ReconstructAtNodes(model, source, kUtiaGrid);
  } else {
    shown = {.source = source,
             .kind = "model",
             .table = Reconstruct(model, source, {}, options.num_threads)};
  }
  LimitAngles(DegreesToRadians(max_angle), &shown);
  const Material material = {[&](const HalfDiffAngles& angles, const Cosines& /*cosines*/) {
                               return brdf(ToDirections(angles));
                             },
                             [&](const SphericalAngles& at) { return brdf(ToDirections(at)); }};
  WriteSpherePair(PictureDataOf(shown), material, path, options);
}

std::string WithoutEnding(const std::string& path) {
  return path.substr(
      0, path.size() -
             std::string(EndsIn(path, kMaterialXEnding) ? kMaterialXEnding : kPrincipledEnding)
                 .size());
}

// The nearest material of renderers that have no other, and how near that is.
void WriteStandard(const std::string& source) {
  const bool materialx = EndsIn(FLAGS_out, kMaterialXEnding);
  const ModelFile file = ModelFor(source, materialx ? kMaterialXEnding : kPrincipledEnding);
  const std::string picture = WithoutEnding(FLAGS_out) + ".png";
  if (FLAGS_picture) Inputs({source, FLAGS_probe}).CheckOutput(picture);
  const double max_angle = file.fit.max_angle > 0 ? file.fit.max_angle : 90;  // [degrees]
  AppearanceOptions options = AppearanceOptionsFromFlags();
  Stopwatch stopwatch;
  const NearestOpenPbr nearest =
      FindNearestOpenPbr(file.model, DegreesToRadians(max_angle), options);
  const SphereError& error = nearest.error;
  const MaterialNotes notes = {
      .name = std::filesystem::path(WithoutEnding(FLAGS_out)).filename().string(),
      .made = "the nearest OpenPBR to " + source + ", found by " + ProgramName(),
      .error = "beside it on a sphere Delta E is " + Text(error.mean_delta_e, 2) +
               " in the mean, below " + Text(error.delta_e_95, 2) + " for 95 %, PSNR " +
               Text(error.psnr_db, 3) + " dB",
      .lost = VerdictOf(error).visibility == Visibility::kNone
                  ? "lost against the model: nothing to be seen"
                  : "lost against the model, " + Words(VerdictOf(error))};
  const std::string text = materialx ? FormatMaterialX(nearest.material, notes)
                                     : FormatPrincipled(nearest.material, notes);
  WriteFile(FLAGS_out, [&](std::ostream& out) { out << text; });
  PrintLine("wrote " + FLAGS_out + ": " +
            (materialx ? "open_pbr_surface" : "inputs of Blender's Principled BSDF") + ", " +
            notes.error + "; " + notes.lost + " (" + Text(stopwatch.Lap(), 2) + " s)");
  if (!FLAGS_picture) return;
  constexpr int kPixels = 160;  // of each sphere
  options.size = kPixels;
  DrawStandard(file.model, source, max_angle, OpenPbrBrdf(nearest.material), picture, options);
  PrintLine("wrote " + picture + ": the model, and what the file has");
}

}  // namespace

bool IsForRenderer(const std::string& path) {
  const std::string ending = EndingOf(path);
  return ending == kTensorEnding || ending == kShaderEnding || IsStandard(path);
}

std::vector<std::string> RendererFlags() { return {"error", "spectral", "picture", "probe"}; }

void CheckRendererFlags(const std::string& path) {
  const bool tensor = EndingOf(path) == kTensorEnding;
  for (const char* const flag : {"error", "spectral"}) {
    if (tensor || IsDefault(flag)) continue;
    throw Error("--" + std::string(flag) + " goes with an --out that ends in .bsdf");
  }
  for (const char* const flag : {"picture", "probe"}) {
    if (IsStandard(path) || IsDefault(flag)) continue;
    throw Error("--" + std::string(flag) +
                " goes with an --out that ends in .mtlx or .principled.json");
  }
}

void WriteForRenderer(const std::string& source) {
  CheckRendererFlags(FLAGS_out);
  if (IsStandard(FLAGS_out)) {
    WriteStandard(source);
  } else if (EndingOf(FLAGS_out) == kShaderEnding) {
    WriteShader(source);
  } else {
    WriteTensorFile(source);
  }
}

}  // namespace trilobe
