#include <gflags/gflags.h>

#include <iostream>
#include <ostream>
#include <string>

#include "trilobe/app/command.h"
#include "trilobe/app/flags.h"
#include "trilobe/app/inputs.h"
#include "trilobe/app/print.h"
#include "trilobe/app/result_folder.h"
#include "trilobe/app/write_measurement.h"
#include "trilobe/base/error.h"
#include "trilobe/brdf/measurement_stats.h"
#include "trilobe/io/csv_file.h"
#include "trilobe/io/file.h"
#include "trilobe/io/merl_file.h"
#include "trilobe/io/model_file.h"
#include "trilobe/io/node_reconstruction.h"
#include "trilobe/io/rgl_export.h"
#include "trilobe/io/source.h"
#include "trilobe/io/utia_file.h"
#include "trilobe/model/reconstruct.h"
#include "trilobe/view/glsl_file.h"

DEFINE_double(error, 0,
              "of a .bsdf file: how far it may be off the model, relative, in the median over "
              "directions; finer tables are taken until it is met. 0: 0.005, of an anisotropic "
              "model 0.02");

namespace trilobe {
namespace {

constexpr const char* kTensorEnding = ".bsdf";
constexpr const char* kShaderEnding = ".glsl";

// A file that is made of a model alone: its errors before any work.
void CheckModelOnly(const std::string& source, const std::string& ending) {
  if (!IsModelFile(source)) {
    throw Error("--out=" + FLAGS_out + ": " + source + " is a measurement, and trilobe writes " +
                ending + " files of models; fit it first");
  }
  RefuseForModel(source, MeasurementFlags());
  Inputs({source}).CheckOutput(FLAGS_out);
  CheckWritable(FLAGS_out);
}

// For shaders.
int ConvertToShader(const std::string& source) {
  if (!IsDefault("error")) throw Error("--error goes with an --out that ends in .bsdf");
  CheckModelOnly(source, kShaderEnding);
  const GlslFile file = FormatGlsl(ReadModel(source), source);
  WriteFile(FLAGS_out, [&](std::ostream& out) { out << file.text; });
  PrintLine("wrote " + FLAGS_out + ": GLSL ES 3.00 with a texture of " +
            std::to_string(file.width) + " x " + std::to_string(file.height) + ", " +
            Text(static_cast<double>(file.text.size()) / 1e6, 2) + " MB");
  return 0;
}

// For renderers that read measurements of RGL.
int ConvertToTensorFile(const std::string& source) {
  if (!(FLAGS_error >= 0 && FLAGS_error <= 1)) throw Error("--error must be from 0 to 1");
  CheckModelOnly(source, kTensorEnding);
  const ModelFile model = ReadModel(source);
  const double measured = model.fit.max_angle > 0 ? model.fit.max_angle : 90;  // [degrees]
  RglExportOptions options{.max_theta = DegreesToRadians(measured)};
  if (FLAGS_error > 0) options.max_error = FLAGS_error;
  const RglExport file = ExportRgl(model.model, options);
  WriteFile(FLAGS_out, [&](std::ostream& out) { out << file.bytes; });
  PrintLine("wrote " + FLAGS_out + ": RGL tensor file, " +
            Text(static_cast<double>(file.bytes.size()) / 1e6, 2) + " MB, off the model by " +
            Text(100 * file.median_error, 2) + " % in the median and " +
            Text(100 * file.high_error, 2) + " % for one of a hundred directions" +
            (measured < 90 ? ", within the " + Text(measured) + " deg that were measured" : ""));
  return 0;
}

Measurement MeasurementOf(const std::string& source, const std::string& out,
                          const SourceOptions& options) {
  if (!IsModelFile(source)) return LoadMeasurement(source, options);
  RefuseForModel(source, {"noise", "extrapolated", "radiometry"});
  const FactorModel model = ReadModel(source).model;
  Measurement measurement;
  if (model.spec().anisotropic()) {
    const std::string ending = EndingOf(out);
    if (ending != ".bin" && ending != ".csv") {
      throw Error("--out=" + out + ": " + source +
                  " is an anisotropic model, which MERL layout cannot hold; end the name in .bin, "
                  "for UTIA's directions, or in .csv");
    }
    measurement = ReconstructAtNodes(model, source, kUtiaGrid);
  } else {
    measurement = {.source = source,
                   .kind = "reconstruction",
                   .table = Reconstruct(model, source, {}, options.num_threads)};
  }
  DecideMeasured(options, &measurement);
  return measurement;
}

int RunConvert(std::span<const std::string> arguments) {
  const std::string& source = arguments[0];
  if (EndingOf(FLAGS_out) == kTensorEnding) return ConvertToTensorFile(source);
  if (EndingOf(FLAGS_out) == kShaderEnding) return ConvertToShader(source);
  if (!IsDefault("error")) throw Error("--error goes with an --out that ends in .bsdf");
  const std::string out = RequiredMeasurementOut("convert");
  Inputs({source}).CheckOutput(out);
  const SourceOptions options = SourceOptionsFromFlags();
  const Measurement measurement = MeasurementOf(source, out, options);
  TellNotes(measurement);
  const std::string written = WriteMeasurement(measurement, out, options.num_threads);
  PrintLine("wrote " + out + ": " + written);
  return 0;
}

}  // namespace

Command ConvertCommand() {
  return {
      .name = "convert",
      .summary = "write a measurement or a model in MERL layout, as CSV, or for a renderer",
      .arguments = "SOURCE|MODEL",
      .min_arguments = 1,
      .max_arguments = 1,
      .details =
          "Evaluates the input at the bin centres of a MERL .binary file and writes that to "
          "--out, so that\nevery MERL viewer can show it. A MERL file is copied bit for bit. Of "
          "an "
          "RGL file, bins that were not\nmeasured are marked invalid (-1), unless --extrapolated "
          "is given. For a model file, all bins with both\ndirections above the surface are "
          "filled; "
          "elsewhere bins are marked invalid. An\nanisotropic model is evaluated at the "
          "directions "
          "of the UTIA database, for a .bin or .csv file. With --max_angle or\n--min_theta_d, "
          "bins "
          "beyond them are "
          "marked "
          "invalid, "
          "too, whatever the input. Scattered samples have no bins: that is an error.\nTo a FILE "
          "that ends in .csv it writes the valid samples, scattered ones too, a row each, with "
          "all "
          "their\ndigits; a whole table takes some 130 MB. To a FILE that ends in .bin it writes "
          "the input at the\ndirections of the UTIA database, -1 where it was not measured; "
          "scattered samples must stand at them.\nOf a model, to a FILE that ends in .bsdf it "
          "writes an RGL tensor file, which Mitsuba 3 renders (`measured`), and to one that ends "
          "in .glsl\nfunctions for shaders.\nA FILE with another "
          "ending is an error.",
      .flags = WithSourceFlags({"out", "error"}),
      .run = RunConvert};
}

}  // namespace trilobe
