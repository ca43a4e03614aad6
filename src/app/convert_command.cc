#include <gflags/gflags.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <ostream>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "app/command.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "app/program.h"
#include "app/result_folder.h"
#include "app/status.h"
#include "core/files/file.h"
#include "fit/reports/print.h"
#include "io/formats/databases/utia_file.h"
#include "io/formats/source_option.h"
#include "io/formats/text/csv_file.h"
#include "model/measurement/note_symptoms.h"
#include "trilobe/core/base/error.h"
#include "trilobe/fit/as_measurement.h"
#include "trilobe/fit/export/convert.h"
#include "trilobe/fit/fit.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/corruption.h"
#include "trilobe/model/measurement/measurement_stats.h"
#include "trilobe/model/objective/reconstruct.h"

DEFINE_double(error, 0,
              "tolerance of a .bsdf or .zemax.bsdf file: median over directions of its relative "
              "error against the model or the measurement; finer tables are taken until it is met. "
              "0: 0.005, for an anisotropic model 0.02, or the least that files reach, and for a "
              "measurement the error of files of usual size");
DEFINE_string(at, "",
              "for a model and a .csv file: a measurement, at whose directions the values of both "
              "are written, side by side");
DEFINE_bool(picture, false,
            "for a .mtlx, .principled.json, .gltf or .usda file: draw the model and the file's "
            "material, side "
            "by side, into a .png beside it");

namespace trilobe {
namespace {

// Reports foreseeable errors before a fit, which takes seconds.
void CheckOut(const std::string& source) {
  Inputs({source}).CheckOutput(FLAGS_out);
  const std::filesystem::path folder = std::filesystem::path(FLAGS_out).parent_path();
  std::error_code ignored;
  if (!folder.empty() && !std::filesystem::is_directory(folder, ignored)) {
    throw Error(ErrorKind::kFile, "cannot write '" + FLAGS_out + "': there is no folder '" +
                                      folder.string() + "'; make it first")
        .At(FLAGS_out)
        .About("write");
  }
}

ConvertOptions OptionsFromFlags(const std::string& source) {
  if (!(FLAGS_error >= 0 && FLAGS_error <= 1)) {
    throw Error(ErrorKind::kRange, "--error must be from 0 to 1").About("error", FLAGS_error);
  }
  ConvertOptions options{.error = FLAGS_error,
                         .spectral = IsOn("spectral"),
                         .program = ProgramName(),
                         .appearance = AppearanceOptionsFromFlags(),
                         .num_threads = ThreadsFromFlags(),
                         .on_stage = Status::Stage};
  if (FLAGS_picture) {
    const std::string last = EndingOf(FLAGS_out);
    const std::string ending = last == ".json" ? ".principled.json" : last;
    options.picture = FLAGS_out.substr(0, FLAGS_out.size() - ending.size()) + ".png";
    Inputs({source, FLAGS_probe}).CheckOutput(options.picture);
  }
  return options;
}

// Throws Error where a flag is given that is for other files than `path`.
void CheckRendererFlags(const std::string& path) {
  if (!TakesError(path) && !IsDefault("error")) {
    throw Error(ErrorKind::kConflict, "--error goes with an --out that ends in .bsdf")
        .About("error");
  }
  if (!IsTensorFile(path) && EndingOf(path) != ".csv" && !IsDefault("spectral")) {
    throw Error(ErrorKind::kConflict,
                "--spectral goes with an --out that ends in .bsdf, but not in .zemax.bsdf")
        .About("spectral");
  }
  for (const char* const flag : {"picture", "probe"}) {
    if (IsStandardMaterial(path) || IsDefault(flag)) continue;
    throw Error(ErrorKind::kConflict,
                "--" + std::string(flag) +
                    " goes with an --out that ends in .mtlx, .principled.json, "
                    ".gltf or .usda")
        .About(flag);
  }
}

// Writes a model or a measurement to --out as a file that renderers read, by its ending, and says
// on standard output what it is and how far off.
void WriteForRenderer(const std::string& source) {
  CheckRendererFlags(FLAGS_out);
  const std::string& out = FLAGS_out;
  std::vector<std::string> lines;
  if (IsModelFile(source)) {
    RefuseForModel(source, MeasurementFlags());
    CheckOut(source);
    const ConvertOptions options = OptionsFromFlags(source);
    lines = WriteForRenderer(ModelOfSource(source), source, out, options);
  } else {
    CheckOut(source);
    const ConvertOptions options = OptionsFromFlags(source);
    const Measurement measurement = LoadMeasurement(source, SourceOptionsFromFlags());
    PrintNotes(measurement);
    lines = WriteForRenderer(measurement, out, options);
  }
  for (const std::string& line : lines) PrintLine(line);
}

Measurement MeasurementOf(const std::string& source, const std::string& out,
                          const SourceOptions& options) {
  if (!IsModelFile(source)) return LoadMeasurement(source, options);
  std::vector<std::string> of_readers;
  for (const SourceOption& option : AllSourceOptions()) {
    if (!option.changes_values) of_readers.push_back(option.name);
  }
  RefuseForModel(source, of_readers);
  const FactorModel model = ModelOfSource(source).model;
  if (model.spec().anisotropic() && !WritableFormat(out).holds_anisotropic) {
    throw Error(
        ErrorKind::kUnsupported,
        "--out=" + out + ": " + source +
            " is an anisotropic model, which MERL layout cannot hold; end the name in .bin, "
            "for UTIA's directions, or in .csv")
        .About("out", out);
  }
  Measurement measurement = AsMeasurement(model, source, options.num_threads, kUtiaGrid);
  NoteUnread(options, "model", &measurement);
  CorruptBy(options, &measurement);
  DecideMeasured(options, &measurement);
  return measurement;
}

// A table of scattered samples, which have no bins: of the model that a fit makes of them. Says so.
Measurement TableByWayOfAFit(const Measurement& scattered, int num_threads) {
  FitOptions options;
  options.compare = false;
  options.num_threads = num_threads;
  options.on_stage = Status::Stage;
  const FitResult fit = Fit(scattered, options);
  if (fit.model().spec().anisotropic()) TableOf(scattered);  // its error
  PrintLine("fitted " + scattered.source + " by " + std::to_string(fit.stored_parameters) +
            " parameters, as samples have no bins: all values of the table are the model's; "
            "`trilobe fit` says how good it is");
  return AsMeasurement(fit.model(), scattered.source, num_threads, kUtiaGrid);
}

std::string NotSpectral(const std::string& source) {
  return "--spectral goes with an --out that ends in .bsdf, or in .csv of what has wavelengths, "
         "and " +
         source + " has none";
}

void WriteSpectra(const BrdfSamples& at, std::span<const double> wavelengths,
                  const std::function<void(int, std::span<double>)>& spectrum) {
  WriteSpectraCsv(at, wavelengths, spectrum, FLAGS_out);
  PrintLine("wrote " + FLAGS_out + ": " + std::to_string(at.size()) + " samples of " +
            std::to_string(wavelengths.size()) + " wavelengths");
}

// The spectra of a measurement to --out, a CSV file.
void WriteMeasuredSpectra(const std::string& source, const SourceOptions& options) {
  if (IsModelFile(source)) {
    throw ErrorIn(ErrorKind::kConflict, source,
                  "--spectral and an --out in .csv take the directions of --at=MEASUREMENT")
        .About("spectral");
  }
  const Measurement measurement = LoadMeasurement(source, options);
  PrintNotes(measurement);
  const BrdfSamples& samples = measurement.samples;
  if (samples.spectra == nullptr) {
    throw Error(ErrorKind::kMissing, NotSpectral(source)).At(source).About("spectra");
  }
  WriteSpectra(samples, samples.spectra->wavelengths, [&](int j, std::span<double> row) {
    std::ranges::copy(samples.SpectrumOf(j), row.begin());
  });
}

// Writes the values of a model beside those of the measurement --at to --out.
void WriteAt(const std::string& source) {
  if (!IsModelFile(source)) {
    throw ErrorIn(ErrorKind::kConflict, source, "--at goes with a model").About("at");
  }
  if (EndingOf(FLAGS_out) != ".csv") {
    throw Error(ErrorKind::kConflict, "--at goes with an --out that ends in .csv").About("at");
  }
  Inputs({source, FLAGS_at}).CheckOutput(FLAGS_out);
  SourceOptions options = SourceOptionsFromFlags();
  options.may_lack_values = true;
  const ModelFile file = ModelOfSource(source);
  if (IsOn("spectral") && !file.spectral) {
    throw Error(ErrorKind::kMissing, NotSpectral(source)).At(source).About("spectra");
  }
  const FactorModel& model = file.model;
  Measurement measurement = MeasurementOfSource(FLAGS_at, options);
  PrintNotes(measurement);
  const BrdfSamples samples = SamplesOf(measurement);
  if (IsOn("spectral")) {
    WriteSpectra(samples, file.spectral->wavelengths(), [&](int j, std::span<double> rho) {
      const DirectionPair pair = samples.directions.empty() ? ToDirections(samples.Angles(j))
                                                            : ToDirections(samples.directions[j]);
      std::ranges::copy(Evaluate(*file.spectral, pair), rho.begin());
    });
    return;
  }
  std::vector<Rgb> values = EvaluateSamples(model, samples, options.num_threads);
  if (AllAreZero(samples)) {
    measurement.table = std::nullopt;
    measurement.samples = samples;
    measurement.samples.rho = std::move(values);
    PrintLine("wrote " + FLAGS_out + ": " + WriteMeasurement(measurement, FLAGS_out) +
              " of the model");
    return;
  }
  WriteBesideCsv(samples, values, FLAGS_out);
  PrintLine("wrote " + FLAGS_out + ": " + std::to_string(samples.size()) +
            " samples, measured and fitted");
}

std::string ListOfCorruptions() {
  std::string text;
  for (const CorruptionKind& kind : CorruptionKinds()) {
    text += "\n  " + kind.name + ", from " + Text(kind.min) + " to " + Text(kind.max) + " [" +
            kind.unit + "]: " + kind.formula;
  }
  return text;
}

int RunConvert(std::span<const std::string> arguments) {
  const std::string& source = arguments[0];
  if (!FLAGS_at.empty()) {
    CheckRendererFlags(FLAGS_out);
    WriteAt(source);
    return 0;
  }
  if (IsForRenderer(FLAGS_out)) {
    WriteForRenderer(source);
    return 0;
  }
  CheckRendererFlags(FLAGS_out);
  const std::string out = RequiredMeasurementOut("convert");
  Inputs({source}).CheckOutput(out, CheckMayReplaceMeasurement);
  SourceOptions options = SourceOptionsFromFlags();
  options.as_they_are = true;
  if (IsOn("spectral")) {
    WriteMeasuredSpectra(source, options);
    return 0;
  }
  Measurement measurement = MeasurementOf(source, out, options);
  PrintNotes(measurement);
  if (!measurement.table && !WritableFormat(out).holds_anisotropic) {
    measurement = TableByWayOfAFit(measurement, options.num_threads);
  }
  const std::string written = ReplaceMeasurement(measurement, out, options.num_threads);
  PrintLine("wrote " + out + ": " + written);
  return 0;
}

}  // namespace

Command ConvertCommand() {
  return {
      .name = "convert",
      .summary = "write a measurement or a model in MERL layout, as CSV, or for a renderer",
      .arguments = "SOURCE|MODEL",
      .doing = "converting",
      .min_arguments = 1,
      .max_arguments = 1,
      .details =
          "Evaluates the input at the bin centres of a MERL .binary file and writes that to --out, "
          "so that\nevery MERL viewer can show it. A MERL file is copied bit for bit. Of an RGL "
          "file, bins that were not\nmeasured are marked invalid (-1), unless --extrapolated is "
          "given. For a model file, all bins with both\ndirections above the surface are filled; "
          "elsewhere bins are marked invalid. An\nanisotropic model is evaluated at the "
          "directions of the UTIA database, for a .bin or .csv file. With --max_angle "
          "or\n--min_theta_d, bins beyond them are marked invalid, too, whatever the input. "
          "Scattered samples have no bins: a table of them is that of a fitted model.\nTo a FILE "
          "that ends in .csv it "
          "writes the valid samples, scattered ones too, a row each, with all their\ndigits; a "
          "whole table takes some 130 MB. To a FILE that ends in .bin it writes the input at "
          "the\ndirections of the UTIA database, -1 where it was not measured; scattered samples "
          "must stand at them.\nTo a FILE that ends in .bsdf it writes an RGL tensor file, which "
          "Mitsuba 3 renders (`measured`), and with\n--spectral pbrt-v4: of a model, or of a "
          "measurement, to which a model is fitted for that, which takes\nseconds; its values are "
          "those measured, and the model's where nothing was. To a FILE that ends in .zemax.bsdf "
          "it writes the\nsame as a table for OpticStudio, in .xml as Klems matrices for "
          "Radiance and WINDOW, and in .xompt, if it is isotropic, for OpenMATERIAL 3D. Of a "
          "model, to a FILE that ends in "
          ".glsl or .hlsl it writes\nfunctions for shaders; of both, to one that ends in .mtlx the "
          "nearest "
          "OpenPBR of MaterialX, in\n.principled.json that of Blender's Principled BSDF, and in "
          ".gltf or .usda "
          "metallic, roughness and base colour for engines and USD's preview, on a sphere, with "
          "how near it is. A FILE with another ending is an error.\nWith "
          "--at=MEASUREMENT it writes a row per sample of that, with theta_i, phi_i, theta_o and "
          "phi_o [degrees] and the\nmeasured and the model's values [1/sr], to a FILE that ends in "
          ".csv.\n\nkinds of corruption "
          "(--corrupt=KIND:STRENGTH,...), x the strength, rho the BRDF, b = rho cos "
          "theta_i the signal:" +
          ListOfCorruptions(),
      .flags = WithSourceFlags({"out", "at", "error", "spectral", "picture", "probe"}),
      .run = RunConvert};
}

}  // namespace trilobe
