#include "app/write_for_renderer.h"

#include <gflags/gflags.h>

#include <filesystem>
#include <ostream>
#include <system_error>

#include "app/flags.h"
#include "app/inputs.h"
#include "app/materials.h"
#include "app/result_folder.h"
#include "files/file.h"
#include "reports/print.h"
#include "system/stopwatch.h"
#include "trilobe/base/error.h"
#include "trilobe/fit/fit.h"
#include "trilobe/formats/completed_measurement.h"
#include "trilobe/formats/rgl_export.h"
#include "trilobe/formats/source.h"
#include "trilobe/results/model_file.h"
#include "view/glsl_file.h"

DEFINE_double(error, 0,
              "of a .bsdf file: how far it may be off the model or the measurement, relative, in "
              "the median over directions; finer tables are taken until it is met. 0: 0.005, of an "
              "anisotropic model 0.02, and of a measurement as near as files of usual size come");
DEFINE_bool(spectral, false,
            "of a .bsdf file: spectra in place of RGB, for spectral renderers (Mitsuba's spectral "
            "variants, pbrt-v4); the others cannot read it");

namespace trilobe {
namespace {

constexpr const char* kTensorEnding = ".bsdf";
constexpr const char* kShaderEnding = ".glsl";

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
    throw Error("cannot write '" + FLAGS_out + "': there is no folder '" + folder.string() + "'");
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

// A file that is made of a model alone, without the flags of others: its errors before any work.
ModelFile ModelFor(const std::string& source, const std::string& ending) {
  for (const std::string& flag : RendererFlags()) {
    if (!IsDefault(flag)) throw Error("--" + flag + " goes with an --out that ends in .bsdf");
  }
  if (!IsModelFile(source)) {
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

}  // namespace

bool IsForRenderer(const std::string& path) {
  const std::string ending = EndingOf(path);
  return ending == kTensorEnding || ending == kShaderEnding;
}

std::vector<std::string> RendererFlags() { return {"error", "spectral"}; }

void WriteForRenderer(const std::string& source) {
  EndingOf(FLAGS_out) == kShaderEnding ? WriteShader(source) : WriteTensorFile(source);
}

}  // namespace trilobe
